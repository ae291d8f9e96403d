#pragma once

#include <cstdint>
#include <vector>

#include "perch/model/mesh.hpp"
#include "perch/model/voxel_grid.hpp"
#include "perch/parallel/executor.hpp"

namespace perch {

/// How often the surface of a closed mesh wraps each voxel's centre, modulo 65,536: 0 outside. \param grid
/// holds the mesh and a voxel more on each side. Throws Interrupted when the stop condition strikes.
std::vector<std::uint16_t> winding_numbers(const Mesh& mesh, const VoxelGrid& grid, const Executor& executor,
                                           const StopCondition& stop);

}  // namespace perch
