#pragma once

#include <Eigen/Core>
#include <vector>

#include "perch/parallel/executor.hpp"

namespace perch {

/// Squared Euclidean distance, in voxels, from every voxel to the nearest one whose value is 0 (the others
/// hold infinity). In place; x runs fastest. One axis after the other: along z by counting there and back,
/// along y and x as the least of what the neighbours have + d d, as far as d can matter, which distances tell
/// that have been found beside (Saito and Toriwaki, "New Algorithms for Euclidean Distance Transformation",
/// 1994). Exact up to 4,096 voxels away. Throws Interrupted when the stop condition strikes.
void squared_distance_transform(std::vector<float>& grid, const Eigen::Vector3i& size,
                                const Executor& executor, const StopCondition& stop = StopCondition());

}  // namespace perch
