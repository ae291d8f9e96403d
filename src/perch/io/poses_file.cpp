#include "perch/io/poses_file.hpp"

#include <fmt/format.h>

#include <new>

#include "perch/core/error.hpp"
#include "perch/io/message.hpp"
#include "perch/io/model_names.hpp"
#include "perch/io/yaml_entry.hpp"

namespace perch {

namespace {

// JSON is YAML, and the one reader gives both files the same checks and messages.
std::vector<PlacedModel> read_list(const YamlEntry& list, const Scene& scene) {
  std::vector<PlacedModel> placed;
  for (const YamlEntry& item : list.items("{model, x, y, yaw}"))
    placed.push_back(placed_model(item.fields(placed_model_keys), scene.models));
  return placed;
}

template <typename Read>
auto reading(const std::filesystem::path& path, const Read& read) {
  try {
    return read(YamlEntry::read(path));
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw InputError(fmt::format("{}: there is not enough memory to read it; split the file", shown(path)));
  } catch (const std::exception& e) {
    throw InputError(fmt::format("{}: can't be read ({}); check the file", shown(path), one_line(e.what())));
  }
}

}  // namespace

std::vector<std::vector<PlacedModel>> read_poses(const std::filesystem::path& path, const Scene& scene) {
  return reading(path, [&](const YamlEntry& root) {
    std::vector<std::vector<PlacedModel>> scenes;
    for (const YamlEntry& list : root.items("lists of {model, x, y, yaw}"))
      scenes.push_back(read_list(list, scene));
    return scenes;
  });
}

std::vector<PlacedModel> read_priors(const std::filesystem::path& path, const Scene& scene) {
  return reading(path, [&](const YamlEntry& root) { return read_list(root, scene); });
}

}  // namespace perch
