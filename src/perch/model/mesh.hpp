#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace perch {

/// A triangle mesh in its model's frame, metres.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  Eigen::AlignedBox3f bounds() const;
};

/// What is wrong with a mesh as an object's model, as one clause ("has no triangles", "vertex 12 is not
/// finite", "triangle 3 names vertex 99 of 40"), or an empty string.
std::string mesh_fault(const Mesh& mesh);

/// The mesh lowered or raised so that its lowest point lies at z = 0; x and y stay.
Mesh stood_on_ground(Mesh mesh);

/// True where, after merging equal vertices, every edge is run along equally often in both directions: the
/// surface then bounds a solid, every line crosses it into the solid as often as out of it. Thinned meshes
/// often have edges that four triangles share; these are closed too.
bool is_closed(const Mesh& mesh);

}  // namespace perch
