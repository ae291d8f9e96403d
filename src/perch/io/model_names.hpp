#pragma once

#include <cstddef>
#include <vector>

#include "perch/io/yaml_entry.hpp"
#include "perch/localize/scene.hpp"

namespace perch {

/// The number of the model that an entry names; throws InputError with the names known. For use inside io.
std::size_t model_index(const YamlEntry& entry, const std::vector<SceneModel>& models);

/// {model, x, y, yaw}: metres and radians in the world. Throws InputError. For use inside io.
PlacedModel placed_model(const YamlFields& fields, const std::vector<SceneModel>& models);

}  // namespace perch
