#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace perch {

/// Evenly spread directions: the vertices of an icosahedron whose triangles are split into four, again and
/// again, on the unit sphere.
struct Icosphere {
  std::vector<Eigen::Vector3d> vertices;  ///< unit vectors
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// \param subdivisions >= 0: 12, 42, 162, 642 ... (10 * 4^subdivisions + 2) vertices.
Icosphere icosphere(int subdivisions);

}  // namespace perch
