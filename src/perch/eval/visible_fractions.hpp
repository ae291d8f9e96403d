#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "perch/localize/scene.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {

/// How much of each true object the camera sees: of the pixels that it would cover alone, the share at which
/// it is the nearest; 0 where it covers none. Of two at the same depth the first is seen. \param alone each
/// true object rendered by itself.
std::vector<double> visible_fractions(const std::vector<DepthPatch>& alone);

/// The `visible` list of the truth.json beside a scene file, one fraction for each true object; empty where
/// there is no such file or list. Throws InputError, one line that names file, key and remedy, for a file
/// that is no JSON and for a list that isn't of as many numbers from 0 to 1.
std::optional<std::vector<double>> read_visible_fractions(const std::filesystem::path& scene_file,
                                                          const Scene& scene);

}  // namespace perch
