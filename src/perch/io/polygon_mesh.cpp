#include "perch/io/polygon_mesh.hpp"

#include <Eigen/Geometry>
#include <bit>
#include <limits>
#include <numeric>
#include <unordered_map>

namespace perch {
namespace {

/// Newell's normal: twice the polygon's area, along the side from which it runs counter-clockwise.
Eigen::Vector3d newell_normal(std::span<const Eigen::Vector3d> polygon) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    // Relative to a corner, so that a polygon far from the origin keeps its digits.
    const Eigen::Vector3d a = polygon[i] - polygon[0];
    const Eigen::Vector3d b = polygon[(i + 1) % polygon.size()] - polygon[0];
    normal += a.cross(b);
  }
  return normal;
}

/// Twice the signed area of the triangle a b c.
double area(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// The polygon seen along its normal, counter-clockwise.
std::vector<Eigen::Vector2d> flattened(std::span<const Eigen::Vector3d> polygon) {
  const Eigen::Vector3d normal = newell_normal(polygon);
  Eigen::Index dropped = 0;
  normal.cwiseAbs().maxCoeff(&dropped);
  const Eigen::Index u = (dropped + 1) % 3, v = (dropped + 2) % 3;
  std::vector<Eigen::Vector2d> flat;
  flat.reserve(polygon.size());
  for (const Eigen::Vector3d& p : polygon) {
    const Eigen::Vector3d q = p - polygon[0];
    // Seen from behind, the polygon would run clockwise.
    flat.push_back(normal[dropped] >= 0 ? Eigen::Vector2d(q[u], q[v]) : Eigen::Vector2d(q[v], q[u]));
  }
  return flat;
}

bool is_ear(const std::vector<Eigen::Vector2d>& flat, const std::vector<std::uint32_t>& left, std::size_t i) {
  const std::size_t n = left.size();
  const Eigen::Vector2d &a = flat[left[(i + n - 1) % n]], &b = flat[left[i]], &c = flat[left[(i + 1) % n]];
  if (!(area(a, b, c) > 0)) return false;
  for (std::size_t k = 2; k + 1 < n; ++k) {
    const Eigen::Vector2d& p = flat[left[(i + k) % n]];
    if (p == a || p == b || p == c) continue;
    if (area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0) return false;
  }
  return true;
}

struct Hash {
  std::size_t operator()(const Eigen::Vector3f& p) const {
    std::uint64_t h = 0;
    for (int k = 0; k < 3; ++k) {
      h = (h ^ std::bit_cast<std::uint32_t>(p[k])) * 0x9e3779b97f4a7c15ULL;
      h ^= h >> 32;
    }
    return static_cast<std::size_t>(h);
  }
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulated(std::span<const Eigen::Vector3d> polygon) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  if (polygon.size() == 3) return {{0, 1, 2}};
  const std::vector<Eigen::Vector2d> flat = flattened(polygon);
  std::vector<std::uint32_t> left(polygon.size());
  std::iota(left.begin(), left.end(), 0U);
  while (left.size() > 3) {
    std::size_t ear = 0;
    while (ear < left.size() && !is_ear(flat, left, ear)) ++ear;
    // Every simple polygon has an ear; one that crosses itself may have none, and any corner does.
    if (ear == left.size()) ear = 0;
    const std::size_t n = left.size();
    triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  if (left.size() == 3) triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

Mesh joined(const PolygonMesh& polygons, double metres_per_unit) {
  constexpr std::size_t most_corners = 1000;
  constexpr std::uint32_t unset = std::numeric_limits<std::uint32_t>::max();
  Mesh mesh;
  std::unordered_map<Eigen::Vector3f, std::uint32_t, Hash> numbers;
  std::vector<std::uint32_t> number_of(polygons.vertices.size(), unset);
  const auto number = [&](std::uint32_t vertex) {
    if (number_of[vertex] != unset) return number_of[vertex];
    // 0 added: -0 and 0 are one place.
    const Eigen::Vector3f p =
        (polygons.vertices[vertex] * metres_per_unit).cast<float>() + Eigen::Vector3f::Zero();
    if (mesh.vertices.size() >= unset) throw FormatFault{"has more vertices than can be numbered"};
    const auto [it, fresh] = numbers.try_emplace(p, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (fresh) mesh.vertices.push_back(p);
    return number_of[vertex] = it->second;
  };
  std::vector<Eigen::Vector3d> polygon;
  std::size_t begin = 0;
  for (const std::size_t end : polygons.ends) {
    const std::span<const std::uint32_t> corners(polygons.corners.data() + begin, end - begin);
    begin = end;
    if (corners.size() < 3) continue;
    if (corners.size() > most_corners)
      throw FormatFault{"has a face of " + std::to_string(corners.size()) +
                        " corners; cut it into triangles"};
    polygon.clear();
    for (const std::uint32_t corner : corners) polygon.push_back(polygons.vertices[corner]);
    for (const auto& t : triangulated(polygon)) {
      const std::array<std::uint32_t, 3> triangle{number(corners[t[0]]), number(corners[t[1]]),
                                                  number(corners[t[2]])};
      if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
        mesh.triangles.push_back(triangle);
    }
  }
  return mesh;
}

}  // namespace perch
