#pragma once

#include <filesystem>

#include "perch/localize/scene.hpp"

namespace perch {

/// Reads a scene file (YAML, so JSON too) with its images and meshes, and checks all of it: no unknown or
/// repeated keys, types, ranges, image sizes, meshes. Paths in the file are relative to it. The result is in
/// metres and radians, meshes stand on z = 0, the scene is named after the file. Without
/// `observation.background` the background counts as removed.
/// Throws InputError, one line `<file>: <key>: <value and what is wrong>; <remedy>`, and nothing else.
Scene read_scene(const std::filesystem::path& scene_file);

}  // namespace perch
