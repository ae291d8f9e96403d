#pragma once

#include <Eigen/Core>
#include <vector>

namespace perch {

/// Squared Euclidean distance, in voxels, from every voxel to the nearest one whose value is 0 (the others
/// hold infinity). In place; x runs fastest. Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled
/// Functions", 2012.
void squared_distance_transform(std::vector<float>& grid, const Eigen::Vector3i& size);

}  // namespace perch
