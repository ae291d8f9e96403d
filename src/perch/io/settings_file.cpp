#include "perch/io/settings_file.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <set>
#include <string>

#include "perch/core/error.hpp"
#include "perch/io/message.hpp"
#include "perch/io/read_file.hpp"

namespace perch {
namespace {

constexpr std::uintmax_t most_bytes = 1 << 20;

constexpr int deepest = 4;  // groups within groups; an alias that holds itself has no end

void apply(const YAML::Node& node, const std::string& prefix, int depth, const std::string& file,
           Settings& settings) {
  if (depth > deepest)
    throw InputError(fmt::format("{}: {}: is nested too deep; write {}: VALUE", file, prefix, "group.field"));
  std::set<std::string> seen;
  for (const auto& entry : node) {
    if (!entry.first.IsScalar())
      throw InputError(fmt::format("{}: a key is no plain word; write cost.delta: 0.005", file));
    if (!seen.insert(one_line(entry.first.Scalar())).second)
      throw InputError(fmt::format("{}: {}: is given twice; keep one", file, one_line(entry.first.Scalar())));
    const std::string key =
        prefix.empty() ? one_line(entry.first.Scalar()) : prefix + "." + one_line(entry.first.Scalar());
    if (entry.second.IsMap()) {
      apply(entry.second, key, depth + 1, file, settings);
    } else if (!entry.second.IsScalar()) {
      throw InputError(fmt::format("{}: {}: is no single value; write {}: VALUE", file, key, key));
    } else {
      try {
        set_field(settings, key, one_line(entry.second.Scalar()));
      } catch (const InvalidSetting& error) {
        throw InputError(fmt::format("{}: {}", file, error.what()));
      }
    }
  }
}

}  // namespace

void read_settings(const std::filesystem::path& path, Settings& settings) {
  const std::string bytes = read_file(path, most_bytes);
  const std::string file = shown(path);
  try {
    const YAML::Node root = YAML::Load(bytes);
    if (root.IsNull()) return;
    if (!root.IsMap())
      throw InputError(fmt::format("{}: is no map of settings; write e.g. cost: {{delta: 0.005}}", file));
    apply(root, "", 0, file, settings);
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}: line {}: {}; correct the YAML", file, error.mark.line + 1, error.msg));
  }
}

}  // namespace perch
