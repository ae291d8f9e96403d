#include "perch/io/model_names.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "perch/io/message.hpp"

namespace perch {

std::size_t model_index(const YamlEntry& entry, const std::vector<SceneModel>& models) {
  const std::string name = entry.text();
  const auto it =
      std::find_if(models.begin(), models.end(), [&](const SceneModel& m) { return m.name == name; });
  if (it == models.end()) {
    std::vector<std::string> names;
    for (const SceneModel& model : models) names.push_back(model.name);
    entry.fail(fmt::format("{} is no model of the scene; {}", entry.value(), did_you_mean(name, names)));
  }
  return static_cast<std::size_t>(it - models.begin());
}

PlacedModel placed_model(const YamlFields& fields, const std::vector<SceneModel>& models) {
  const char* remedy = "give model, x, y (metres) and yaw (radians)";
  PlacedModel placed;
  placed.model = model_index(fields.required("model", remedy), models);
  placed.pose.x = fields.required("x", remedy).number("metres");
  placed.pose.y = fields.required("y", remedy).number("metres");
  placed.pose.yaw = fields.required("yaw", remedy).number("radians");
  if (const YamlEntry* entry = fields.optional("rest_pose")) {
    const auto poses = static_cast<int>(rest_pose_count(models, placed.model));
    placed.model += static_cast<std::size_t>(entry->integer(0, poses - 1));
  }
  return placed;
}

}  // namespace perch
