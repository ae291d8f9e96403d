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

bool is_closed(const Mesh& mesh) {
  // Files often repeat a vertex for each of its triangles; the surface doesn't.
  std::map<std::tuple<float, float, float>, std::uint32_t> numbers;
  std::vector<std::uint32_t> merged(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f& p = mesh.vertices[i];
    merged[i] = numbers
                    .try_emplace({p.x() + 0.0F, p.y() + 0.0F, p.z() + 0.0F},
                                 static_cast<std::uint32_t>(numbers.size()))
                    .first->second;
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(mesh.triangles.size() * 3);
  for (const auto& triangle : mesh.triangles) {
    const std::array<std::uint32_t, 3> t{merged[triangle[0]], merged[triangle[1]], merged[triangle[2]]};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;  // no area, no edges of its own
    for (int k = 0; k < 3; ++k) edges.emplace_back(t[k], t[(k + 1) % 3]);
  }
  if (edges.empty()) return false;
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
  return std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    return std::binary_search(edges.begin(), edges.end(), std::pair{edge.second, edge.first});
  });
}

}  // namespace perch
