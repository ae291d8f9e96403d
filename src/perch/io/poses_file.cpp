#include "perch/io/poses_file.hpp"

#include <fmt/format.h>

#include <new>

#include "perch/core/error.hpp"
#include "perch/io/message.hpp"
#include "perch/io/model_names.hpp"
#include "perch/io/yaml_entry.hpp"

namespace perch {

std::vector<std::vector<PlacedModel>> read_poses(const std::filesystem::path& path, const Scene& scene) {
  try {
    std::vector<std::vector<PlacedModel>> scenes;
    // JSON is YAML, and the one reader gives both files the same checks and messages.
    for (const YamlEntry& list : YamlEntry::read(path).items("lists of {model, x, y, yaw}")) {
      std::vector<PlacedModel>& placed = scenes.emplace_back();
      for (const YamlEntry& item : list.items("{model, x, y, yaw}"))
        placed.push_back(placed_model(item.fields({"model", "x", "y", "yaw"}), scene.models));
    }
    return scenes;
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw InputError(fmt::format("{}: there is not enough memory to read it; split the file", shown(path)));
  } catch (const std::exception& e) {
    throw InputError(fmt::format("{}: can't be read ({}); check the file", shown(path), one_line(e.what())));
  }
}

}  // namespace perch
