#include "perch/model/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numeric>

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

/// Of each vertex the first one at its place: files often repeat a vertex for each of its triangles, the
/// surface doesn't.
std::vector<std::uint32_t> merged_vertices(const Mesh& mesh) {
  // A hash table without lists: where a place is taken by another vertex, the next free one is used. A power
  // of two, twice as many places as vertices at least, so that there always is one.
  const std::size_t places = std::bit_ceil(2 * mesh.vertices.size() + 1);
  constexpr std::uint32_t empty = 0;  // else a vertex's number + 1
  std::vector<std::uint32_t> table(places, empty);
  std::vector<std::uint32_t> merged(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f& p = mesh.vertices[i];
    std::uint64_t hash = 0;
    for (const float x : {p.x(), p.y(), p.z()}) {
      hash = (hash ^ std::bit_cast<std::uint32_t>(x + 0.0F)) * 0x9e3779b97f4a7c15U;  // -0 is 0
      hash ^= hash >> 32;
    }
    std::size_t place = hash & (places - 1);
    while (table[place] != empty && mesh.vertices[table[place] - 1] != p) place = (place + 1) & (places - 1);
    if (table[place] == empty) table[place] = static_cast<std::uint32_t>(i) + 1;
    merged[i] = table[place] - 1;
  }
  return merged;
}

}  // namespace

bool is_closed(const Mesh& mesh) {
  const std::vector<std::uint32_t> merged = merged_vertices(mesh);
  const auto for_each_edge = [&](const auto& visit) {
    for (const auto& [i, j, k] : mesh.triangles) {
      const std::uint32_t a = merged[i], b = merged[j], c = merged[k];
      if (a == b || b == c || c == a) continue;  // no area, no edges of its own
      visit(a, b);
      visit(b, c);
      visit(c, a);
    }
  };
  // Edges in the order of their lower vertex, by counting: of each its higher one and the direction it is run
  // along.
  struct Edge {
    std::uint32_t higher;
    int direction;
  };
  std::vector<std::size_t> end(mesh.vertices.size() + 1, 0);
  for_each_edge([&](std::uint32_t a, std::uint32_t b) { ++end[std::min(a, b) + 1]; });
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<Edge> edges(end.back());
  if (edges.empty()) return false;
  for_each_edge([&](std::uint32_t a, std::uint32_t b) {
    edges[end[std::min(a, b)]++] = a < b ? Edge{b, 1} : Edge{a, -1};
  });
  std::vector<std::int64_t> balance(mesh.vertices.size(), 0);
  std::size_t first = 0;
  for (std::size_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
    const std::size_t last = end[vertex];
    for (std::size_t i = first; i < last; ++i) balance[edges[i].higher] += edges[i].direction;
    for (; first < last; ++first)
      if (balance[edges[first].higher] != 0) return false;
  }
  return true;
}

}  // namespace perch
