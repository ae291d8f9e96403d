#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "perch/io/format_fault.hpp"
#include "perch/model/mesh.hpp"

namespace perch {

/// Polygons as a mesh file holds them, in its unit.
struct PolygonMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::uint32_t> corners;  ///< of all polygons, one after another, counting into vertices
  std::vector<std::size_t> ends;       ///< where each polygon's corners end
};

/// Cuts a plane polygon of 3 or more corners, convex or not, into triangles with its orientation, by clipping
/// ears. Returns numbers of corners. Corners that enclose nothing (repeated, or on one line) still give
/// triangles, without area. Takes up to O(n^3).
std::vector<std::array<std::uint32_t, 3>> triangulated(std::span<const Eigen::Vector3d> polygon);

/// The surface in metres: polygons cut into triangles, vertices at the same place joined, and left out
/// whatever is then no triangle (points, lines) and vertices that no triangle names. Throws FormatFault where
/// there is too much of it.
Mesh joined(const PolygonMesh& polygons, double metres_per_unit);

}  // namespace perch
