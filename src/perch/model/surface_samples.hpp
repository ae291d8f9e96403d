#pragma once

#include <Eigen/Core>
#include <vector>

#include "perch/model/mesh.hpp"
#include "perch/model/voxel_grid.hpp"
#include "perch/parallel/executor.hpp"

namespace perch {

/// Points on the mesh's triangles such that every point of the surface has one within spacing / sqrt(3).
std::vector<Eigen::Vector3f> sample_surface(const Mesh& mesh, float spacing);

/// Sets to 0 what `field` holds for the voxels that have one of these points, and returns those that are the
/// first in their cell of two by two by two voxels. \param grid holds the mesh and a voxel more on each side.
/// Throws Interrupted when the stop condition strikes.
std::vector<Eigen::Vector3f> mark_surface(const Mesh& mesh, float spacing, const VoxelGrid& grid,
                                          std::vector<float>& field, const Executor& executor,
                                          const StopCondition& stop);

}  // namespace perch
