#include "perch/io/settings_file.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <set>
#include <string>
#include <vector>

#include "perch/core/error.hpp"
#include "perch/io/message.hpp"
#include "perch/io/read_file.hpp"

namespace perch {
namespace {

constexpr std::uintmax_t most_bytes = 1 << 20;

constexpr int deepest_group = 4;  // groups within groups; an alias that holds itself has no end

/// \param seen the fields set so far, however they were spelled.
void apply(const YAML::Node& node, const std::string& prefix, int depth, const std::string& file,
           std::set<std::string>& seen, Settings& settings) {
  if (depth > deepest_group)
    throw InputError(fmt::format("{}: {}: is nested too deep; write {}: VALUE", file, prefix, "group.field"));
  for (const auto& entry : node) {
    if (!entry.first.IsScalar())
      throw InputError(fmt::format("{}: a key is no plain word; write cost.delta: 0.005", file));
    const std::string key =
        prefix.empty() ? one_line(entry.first.Scalar()) : prefix + "." + one_line(entry.first.Scalar());
    if (entry.second.IsMap()) {
      apply(entry.second, key, depth + 1, file, seen, settings);
    } else if (!entry.second.IsScalar()) {
      throw InputError(fmt::format("{}: {}: is no single value; write {}: VALUE", file, key, key));
    } else {
      if (!seen.insert(key).second)
        throw InputError(fmt::format("{}: {}: is given twice; keep one", file, key));
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
    const std::vector<YAML::Node> documents = YAML::LoadAll(bytes);
    if (documents.size() > 1)
      throw InputError(fmt::format("{}: holds {} YAML documents, not one; keep one", file, documents.size()));
    if (documents.empty() || documents.front().IsNull()) return;
    const YAML::Node& root = documents.front();
    if (!root.IsMap())
      throw InputError(fmt::format("{}: is no map of settings; write e.g. cost: {{delta: 0.005}}", file));
    std::set<std::string> seen;
    apply(root, "", 0, file, seen, settings);
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}: line {}: {}; correct the YAML", file, error.mark.line + 1, error.msg));
  }
}

}  // namespace perch
