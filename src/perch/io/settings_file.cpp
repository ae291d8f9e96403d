#include "perch/io/settings_file.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <string>

#include "perch/core/error.hpp"
#include "perch/io/read_file.hpp"

namespace perch {
namespace {

constexpr std::uintmax_t most_bytes = 1 << 20;

void apply(const YAML::Node& node, const std::string& prefix, const std::string& file, Settings& settings) {
  for (const auto& entry : node) {
    if (!entry.first.IsScalar())
      throw InputError(fmt::format("{}: a key is no plain word; write cost.delta: 0.005", file));
    const std::string key = prefix.empty() ? entry.first.Scalar() : prefix + "." + entry.first.Scalar();
    if (entry.second.IsMap()) {
      apply(entry.second, key, file, settings);
    } else if (!entry.second.IsScalar()) {
      throw InputError(fmt::format("{}: {}: is no single value; write {}: VALUE", file, key, key));
    } else {
      try {
        set_field(settings, key, entry.second.Scalar());
      } catch (const InvalidSetting& error) {
        throw InputError(fmt::format("{}: {}", file, error.what()));
      }
    }
  }
}

}  // namespace

void read_settings(const std::filesystem::path& path, Settings& settings) {
  const std::string bytes = read_file(path, most_bytes);
  try {
    const YAML::Node root = YAML::Load(bytes);
    if (root.IsNull()) return;
    if (!root.IsMap())
      throw InputError(
          fmt::format("{}: is no map of settings; write e.g. cost: {{delta: 0.005}}", path.string()));
    apply(root, "", path.string(), settings);
  } catch (const YAML::Exception& error) {
    throw InputError(
        fmt::format("{}: line {}: {}; correct the YAML", path.string(), error.mark.line + 1, error.msg));
  }
}

}  // namespace perch
