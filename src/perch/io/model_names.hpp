#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "perch/io/yaml_entry.hpp"
#include "perch/localize/scene.hpp"

namespace perch {

/// The number of the first body of the model that an entry names; throws InputError with the names known. For
/// use inside io.
std::size_t model_index(const YamlEntry& entry, const std::vector<SceneModel>& models);

/// The keys that placed_model() reads.
inline const std::vector<std::string> placed_model_keys{"model", "x", "y", "yaw", "rest_pose"};

/// {model, x, y, yaw, rest_pose}: metres and radians in the world; the last may be missing, then it is 0.
/// Throws InputError. For use inside io.
PlacedModel placed_model(const YamlFields& fields, const std::vector<SceneModel>& models);

}  // namespace perch
