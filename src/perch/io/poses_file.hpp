#pragma once

#include <filesystem>
#include <vector>

#include "perch/localize/scene.hpp"

namespace perch {

/// Scenes to be scored: a JSON array of arrays of {model, x, y, yaw, rest_pose}, metres and radians in the
/// world; the models are those of `scene`, and rest_pose is 0 where it is missing. An array may be empty.
/// Throws InputError, one line
/// `<file>: [0][2].yaw: <value and what is wrong>; <remedy>`.
std::vector<std::vector<PlacedModel>> read_poses(const std::filesystem::path& path, const Scene& scene);

/// Poses that another detector proposes: an array of {model, x, y, yaw, rest_pose}. Errors as above.
std::vector<PlacedModel> read_priors(const std::filesystem::path& path, const Scene& scene);

}  // namespace perch
