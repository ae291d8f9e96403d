#include "perch/model/winding_numbers.hpp"

#include <algorithm>
#include <atomic>

namespace perch {
namespace {

constexpr std::size_t triangles_at_once = 128, columns_at_once = 1024;  // of a task

/// A triangle seen from above, for the vertical lines that cross it.
class TriangleFromAbove {
 public:
  TriangleFromAbove(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c)
      : edges_{Edge(a, b), Edge(b, c), Edge(c, a)}, za_(a.z()), zb_(b.z()), zc_(c.z()) {}

  /// +1 or -1 where the line at (x, y) crosses the triangle (by the sense of its normal), and at which z;
  /// else 0. Triangles that share an edge count the line on it exactly once between them.
  int crossing(double x, double y, float& z) const {
    const double e0 = edges_[0].side(x, y), e1 = edges_[1].side(x, y), e2 = edges_[2].side(x, y);
    const double area = e0 + e1 + e2;
    if (area == 0.0) return 0;
    const bool up = area > 0.0;
    if (!edges_[0].holds(e0, up) || !edges_[1].holds(e1, up) || !edges_[2].holds(e2, up)) return 0;
    z = static_cast<float>((e1 * za_ + e2 * zb_ + e0 * zc_) / area);
    return up ? 1 : -1;
  }

 private:
  /// From p to q. Computed from the same end for either triangle that it belongs to.
  class Edge {
   public:
    Edge(const Eigen::Vector3f& p, const Eigen::Vector3f& q)
        : owns_(q.y() > p.y() || (q.y() == p.y() && q.x() > p.x())) {
      const bool flipped = q.x() < p.x() || (q.x() == p.x() && q.y() < p.y());
      const Eigen::Vector3f &s = flipped ? q : p, &t = flipped ? p : q;
      x_ = s.x(), y_ = s.y();
      dx_ = t.x() - x_, dy_ = t.y() - y_;
      sign_ = flipped ? -1.0 : 1.0;
    }
    double side(double x, double y) const { return sign_ * (dx_ * (y - y_) - dy_ * (x - x_)); }
    /// On the edge itself: belongs to the side that sees it run up, or right.
    bool holds(double side, bool up) const { return side == 0.0 ? owns_ == up : (side > 0.0) == up; }

   private:
    bool owns_;
    double x_, y_, dx_, dy_, sign_;
  };
  Edge edges_[3];
  double za_, zb_, zc_;
};

}  // namespace

std::vector<std::uint16_t> winding_numbers(const Mesh& mesh, const VoxelGrid& grid, const Executor& executor,
                                           const StopCondition& stop) {
  const auto for_each_part = [&](std::size_t n, std::size_t at_once, const auto& body) {
    const auto task = [&](std::size_t i, std::size_t) { body(i * at_once, std::min((i + 1) * at_once, n)); };
    if (!executor.for_each((n + at_once - 1) / at_once, task, stop)) throw Interrupted();
  };
  std::vector<std::uint16_t> winding(grid.voxels(), 0);

  // What a vertical line adds where it crosses the surface ...
  const auto nearest_below = [&](float x, int axis, float slack) {
    return static_cast<int>((x - grid.origin(axis)) / grid.voxel + slack);
  };
  const auto add_crossings = [&](std::size_t first, std::size_t last) {
    constexpr float rounding = 0.1F;  // voxels, and more than what rounding moves
    for (std::size_t n = first; n < last; ++n) {
      const auto& [ia, ib, ic] = mesh.triangles[n];
      const Eigen::Vector3f &a = mesh.vertices[ia], &b = mesh.vertices[ib], &c = mesh.vertices[ic];
      const Eigen::Vector3f low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
      const int i0 = nearest_below(low.x(), 0, -rounding) + 1, i1 = nearest_below(high.x(), 0, rounding),
                j0 = nearest_below(low.y(), 1, -rounding) + 1, j1 = nearest_below(high.y(), 1, rounding);
      if (i0 > i1 || j0 > j1) continue;
      const TriangleFromAbove triangle(a, b, c);
      for (int j = j0; j <= j1; ++j)
        for (int i = i0; i <= i1; ++i) {
          const Eigen::Vector3f line = grid.centre(i, j, 0);
          float z = 0.0F;
          const int sense = triangle.crossing(line.x(), line.y(), z);
          if (sense == 0) continue;
          int k = nearest_below(z, 2, 0.0F);
          while (grid.centre(i, j, k - 1).z() >= z) --k;
          while (grid.centre(i, j, k).z() < z) ++k;
          // A sum of integers is the same in any order.
          std::atomic_ref(winding[grid.index(i, j, k)])
              .fetch_add(static_cast<std::uint16_t>(sense), std::memory_order_relaxed);
        }
    }
  };
  for_each_part(mesh.triangles.size(), triangles_at_once, add_crossings);

  // ... holds for all that lies above.
  const std::size_t plane = grid.plane();
  for_each_part(plane, columns_at_once, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = 1; k < grid.planes(); ++k) {
      const std::uint16_t* below = winding.data() + (k - 1) * plane;
      std::uint16_t* row = winding.data() + k * plane;
      for (std::size_t i = first; i < last; ++i) row[i] = static_cast<std::uint16_t>(row[i] + below[i]);
    }
  });
  return winding;
}

}  // namespace perch
