#include "perch/verify/solid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "perch/core/random.hpp"

namespace perch {
namespace {

constexpr std::size_t most_interior_points = 4000;
constexpr std::size_t most_attempts = 100'000;

/// Edges between positions, so that vertices at the same place are one.
bool edges_balance(const Mesh& mesh) {
  std::map<std::tuple<float, float, float>, std::uint32_t> places;
  std::vector<std::uint32_t> place;
  for (const Eigen::Vector3f& p : mesh.vertices)
    place.push_back(
        places.try_emplace({p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(places.size())).first->second);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& triangle : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = place[triangle[i]], to = place[triangle[(i + 1) % 3]];
      if (from < to) ++balance[{from, to}];
      if (to < from) --balance[{to, from}];
    }
  return std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
}

std::vector<Eigen::Vector3d> in_double(const std::vector<Eigen::Vector3f>& points) {
  std::vector<Eigen::Vector3d> out;
  for (const Eigen::Vector3f& p : points) out.push_back(p.cast<double>());
  return out;
}

/// The depth of the deepest surface point of `guest` in `host`; 0 where none is inside.
double deepest_point(const PlacedSolid& guest, const PlacedSolid& host) {
  const Eigen::Isometry3d host_from_guest = host.world_from_model.inverse() * guest.world_from_model;
  double deepest = 0.0;
  for (const Eigen::Vector3d& point : guest.solid->surface_points()) {
    const Eigen::Vector3d p = host_from_guest * point;
    if (host.solid->is_deeper(p, deepest)) deepest = host.solid->distance(p);
  }
  return deepest;
}

double share_inside(const PlacedSolid& guest, const PlacedSolid& host) {
  const auto& points = guest.solid->interior_points();
  if (points.empty()) return 0.0;
  const Eigen::Isometry3d host_from_guest = host.world_from_model.inverse() * guest.world_from_model;
  const auto inside = std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& p) {
    return host.solid->is_inside(host_from_guest * p);
  });
  const double n = static_cast<double>(points.size()), share = static_cast<double>(inside) / n;
  return std::max(0.0, share - 4.0 * std::sqrt(share * (1.0 - share) / n));
}

}  // namespace

Solid::Solid(const Mesh& mesh)
    : vertices_(in_double(mesh.vertices)),
      triangles_(mesh.triangles),
      closed_(edges_balance(mesh)),
      rays_(vertices_, triangles_) {
  for (const Eigen::Vector3d& p : vertices_) bounds_.extend(p);
  sample_surface();
  if (closed_) sample_interior();
}

bool Solid::is_inside(const Eigen::Vector3d& p) const {
  if (!closed_ || !bounds_.contains(p)) return false;
  // Directions along no edge that a mesh is likely to have.
  static const std::array<Eigen::Vector3d, 3> directions{Eigen::Vector3d(0.21, 0.34, 0.92),
                                                         Eigen::Vector3d(-0.83, 0.11, 0.55),
                                                         Eigen::Vector3d(0.31, -0.93, -0.19)};
  return std::all_of(directions.begin(), directions.end(), [&](const Eigen::Vector3d& direction) {
    int winding = 0;
    for (const std::uint32_t t : rays_.all_hits(p, direction)) {
      const Eigen::Vector3d &a = vertices_[triangles_[t][0]], &b = vertices_[triangles_[t][1]],
                            &c = vertices_[triangles_[t][2]];
      winding += (b - a).cross(c - a).dot(direction) > 0.0 ? 1 : -1;
    }
    return winding != 0;
  });
}

double Solid::voxel() const {
  return std::clamp(bounds_.sizes().maxCoeff() / 72.0, 0.0005, 0.01);
}

void Solid::sample_surface() {
  const double spacing = std::max(0.001, bounds_.sizes().maxCoeff() / 100.0);
  surface_ = vertices_;
  for (const auto& [ia, ib, ic] : triangles_) {
    const Eigen::Vector3d &a = vertices_[ia], &b = vertices_[ib], &c = vertices_[ic];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = static_cast<int>(std::ceil(longest / spacing));
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const bool is_corner = (i == 0 || i == n) && (j == 0 || j == n);
        if (n > 1 && !is_corner) surface_.push_back(a + (b - a) * i / n + (c - a) * j / n);
      }
  }
}

void Solid::sample_interior() {
  Random random(1);
  for (std::size_t i = 0; i < most_attempts && interior_.size() < most_interior_points; ++i) {
    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(bounds_.min()[axis], bounds_.max()[axis]);
    if (is_inside(p)) interior_.push_back(p);
  }
}

Overlap overlap_of(const PlacedSolid& a, const PlacedSolid& b) {
  return {std::max(deepest_point(a, b), deepest_point(b, a)),
          std::max(share_inside(a, b), share_inside(b, a))};
}

double depth_slack(const Solid& a, const Solid& b) {
  // 4.1 voxels of the one that is entered, 3.8 of the one whose surface is sampled.
  return std::max(4.1 * a.voxel() + 3.8 * b.voxel(), 3.8 * a.voxel() + 4.1 * b.voxel());
}

}  // namespace perch
