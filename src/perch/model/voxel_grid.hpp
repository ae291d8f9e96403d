#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace perch {

/// Cubes in rows: voxel (i, j, k) is the one whose centre is nearest, and x runs fastest.
struct VoxelGrid {
  float voxel = 0.0F;                                ///< side, metres
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();  ///< centre of voxel (0, 0, 0)
  Eigen::Vector3i size = Eigen::Vector3i::Zero();

  std::size_t rows() const { return static_cast<std::size_t>(size.y()) * static_cast<std::size_t>(size.z()); }
  std::size_t plane() const {
    return static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y());
  }
  std::size_t planes() const { return static_cast<std::size_t>(size.z()); }
  std::size_t voxels() const { return plane() * planes(); }
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size.y()) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(size.x()) +
           static_cast<std::size_t>(i);
  }
  Eigen::Vector3f centre(int i, int j, int k) const {
    return origin +
           voxel * Eigen::Vector3f(static_cast<float>(i), static_cast<float>(j), static_cast<float>(k));
  }
};

}  // namespace perch
