#include "perch/model/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace perch {

Eigen::AlignedBox3f Mesh::bounds() const {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : vertices) box.extend(vertex);
  return box;
}

std::string mesh_fault(const Mesh& mesh) {
  if (mesh.vertices.empty()) return "has no vertices";
  if (mesh.triangles.empty()) return "has no triangles";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!mesh.vertices[i].allFinite()) return fmt::format("has a vertex that is not finite (number {})", i);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t vertex : mesh.triangles[i])
      if (vertex >= mesh.vertices.size())
        return fmt::format("has a triangle (number {}) that names vertex {} of {}", i, vertex,
                           mesh.vertices.size());
  return {};
}

Mesh stood_on_ground(Mesh mesh) {
  const float lowest = mesh.bounds().min().z();
  for (Eigen::Vector3f& vertex : mesh.vertices) vertex.z() -= lowest;
  return mesh;
}

namespace {

/// Of each vertex the number of its place: files often repeat a vertex for each of its triangles, the surface
/// doesn't.
std::vector<std::uint32_t> merged_vertices(const Mesh& mesh) {
  std::map<std::tuple<float, float, float>, std::uint32_t> numbers;
  std::vector<std::uint32_t> merged(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f& p = mesh.vertices[i];
    const std::tuple place{p.x() + 0.0F, p.y() + 0.0F, p.z() + 0.0F};  // -0 is 0
    merged[i] = numbers.try_emplace(place, static_cast<std::uint32_t>(numbers.size())).first->second;
  }
  return merged;
}

}  // namespace

bool is_closed(const Mesh& mesh) {
  const std::vector<std::uint32_t> merged = merged_vertices(mesh);
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Edge> edges;
  edges.reserve(mesh.triangles.size() * 3);
  for (const auto& triangle : mesh.triangles) {
    const std::array<std::uint32_t, 3> t{merged[triangle[0]], merged[triangle[1]], merged[triangle[2]]};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;  // no area, no edges of its own
    for (int k = 0; k < 3; ++k) edges.emplace_back(t[k], t[(k + 1) % 3]);
  }
  if (edges.empty()) return false;
  std::sort(edges.begin(), edges.end());
  std::vector<Edge> reversed;
  reversed.reserve(edges.size());
  for (const Edge& edge : edges) reversed.emplace_back(edge.second, edge.first);
  std::sort(reversed.begin(), reversed.end());
  return edges == reversed;
}

}  // namespace perch
