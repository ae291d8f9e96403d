#pragma once

#include <filesystem>
#include <utility>
#include <vector>

namespace perch {

/// An image of a BOP data set, and how often which models are in it.
struct BopImageTargets {
  int scene_id = 0, im_id = 0;
  std::vector<std::pair<int, int>> objects;  ///< obj_id and how many, ascending
};

/// A list such as test_targets_bop19.json: [{"im_id", "inst_count", "obj_id", "scene_id"}]; the images
/// ascending by scene and number. Throws InputError.
std::vector<BopImageTargets> read_bop_targets(const std::filesystem::path& file);

}  // namespace perch
