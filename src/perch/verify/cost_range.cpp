#include "perch/verify/cost_range.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace perch {
namespace {

/// What is known of the points in a range of depths: each lies within delta of I, none does, or it depends on
/// where.
enum class Near { all, none, some };

class CostCounter {
 public:
  CostCounter(const ObservedPoints& observed, const Intrinsics& intrinsics, const SceneView& view,
              const CountingRule& rule)
      : observed_(observed), k_(intrinsics), view_(view), delta_(rule.delta), rule_(rule) {}

  CostRange count() {
    CostRange cost;
    cost.explained.resize(view_.visible().size());
    for (const SeenPixel& pixel : view_.pixels()) count_rendered(pixel, cost);
    if (!rule_.ignore_points) count_observed(cost);
    return cost;
  }

 private:
  bool counts(const SeenPixel& pixel) const {
    return !rule_.ignore_missing || !observed_.is_unknown(pixel.pixel);
  }

  /// The entry of Bayer's matrix of 8 x 8, by its recursive definition: that of 4 x 4 four times as large,
  /// plus 0, 2, 3 and 1 by quarters.
  static int bayer(int u, int v, int size) {
    if (size == 1) return 0;
    const int half = size / 2;
    constexpr int quarter[2][2] = {{0, 2}, {3, 1}};
    return 4 * bayer(u % half, v % half, half) + quarter[(v / half) % 2][(u / half) % 2];
  }

  /// The depth beyond which a rendered point is left out of R, as hidden by clutter.
  double farthest(std::uint32_t pixel) const {
    constexpr double any = std::numeric_limits<double>::infinity();
    const double reading = observed_.reading(pixel);
    if (!rule_.clutter_weight || reading == 0.0) return any;
    const int u = static_cast<int>(pixel) % k_.width, v = static_cast<int>(pixel) / k_.width;
    return bayer(u % 8, v % 8, 8) < std::lround(64.0 * *rule_.clutter_weight) ? any : reading + delta_;
  }

  Near near_observed(std::uint32_t pixel, const DepthRange& depth) const {
    const Eigen::Vector3d from = point_at(k_, pixel, depth.near), to = point_at(k_, pixel, depth.far);
    const Eigen::Vector3d middle = 0.5 * (from + to);
    const double half = 0.5 * (to - from).norm(), rounding = distance_rounding(middle, delta_);
    const double nearest = observed_.tree().nearest_distance(middle);
    if (nearest - half > delta_ + rounding) return Near::none;
    if (nearest + half <= delta_ - rounding) return Near::all;
    if (half <= 2.0 * rounding) return Near::some;
    const double z = middle.z();
    const Near front = near_observed(pixel, {depth.near, z});
    if (front == Near::some) return front;
    return near_observed(pixel, {z, depth.far}) == front ? front : Near::some;
  }

  void count_rendered(const SeenPixel& pixel, CostRange& cost) const {
    bool all_near = true, none_near = true, all_count = true, any_counts = false;
    const double limit = farthest(pixel.pixel), rounding = std::isinf(limit) ? 0.0 : 2.5e-7 * limit;
    const auto seen = view_.seen(pixel);
    for (auto s = seen.begin(); s != seen.end();) {
      const std::uint32_t object = s->object;
      bool all = true, none = true;  // of this object's ranges
      for (; s != seen.end() && s->object == object; ++s) {
        const Near near = near_observed(pixel.pixel, s->depth);
        all = all && near == Near::all;
        none = none && near == Near::none;
        all_count = all_count && s->depth.far <= limit - rounding;
        any_counts = any_counts || s->depth.near <= limit + rounding;
      }
      cost.explained[object].add(all && view_.is_certain(pixel, object), !none);
      all_near = all_near && all;
      none_near = none_near && none;
    }
    if (counts(pixel)) cost.rendered.add(none_near && !pixel.may_miss && all_count, !all_near && any_counts);
  }

  /// A part of a range of depths, short enough to be looked for by its middle.
  struct Piece {
    std::array<Eigen::Vector3d, 2> ends;
    std::size_t pixel;  ///< counts into the view's
  };

  void count_observed(CostRange& cost) const {
    const double longest = std::max(1e-4, 0.1 * delta_);
    std::vector<Piece> pieces;
    std::vector<Eigen::Vector3d> middles;
    for (std::size_t i = 0; i < view_.pixels().size(); ++i) {
      const SeenPixel& pixel = view_.pixels()[i];
      if (!counts(pixel)) continue;
      for (const Seen& s : view_.seen(pixel)) {
        const Eigen::Vector3d from = point_at(k_, pixel.pixel, s.depth.near),
                              to = point_at(k_, pixel.pixel, s.depth.far);
        const double parts = std::max(1.0, std::ceil((to - from).norm() / longest));
        for (double part = 0.0; part < parts; ++part) {
          pieces.push_back(
              {{from + (to - from) * (part / parts), from + (to - from) * ((part + 1.0) / parts)}, i});
          middles.push_back(0.5 * (pieces.back().ends[0] + pieces.back().ends[1]));
        }
      }
    }
    const KdTree tree(std::move(middles));
    for (const Eigen::Vector3d& p : observed_.points()) {
      const double rounding = distance_rounding(p, delta_);
      bool possible = false;
      const bool certain = tree.any_within(p, delta_ + rounding + longest, [&](std::size_t i) {
        if (distance_to(pieces[i], p) > delta_ + rounding) return false;
        possible = true;
        return explains(view_.pixels()[pieces[i].pixel], p, delta_ - rounding);
      });
      cost.observed.add(!possible, !certain);
    }
  }

  static double distance_to(const Piece& piece, const Eigen::Vector3d& p) {
    const Eigen::Vector3d along = piece.ends[1] - piece.ends[0];
    const double length = along.squaredNorm();
    const double t = length > 0.0 ? std::clamp(along.dot(p - piece.ends[0]) / length, 0.0, 1.0) : 0.0;
    return (piece.ends[0] + t * along - p).norm();
  }

  /// True if the pixel's rendered point lies within `reach` of p wherever it is.
  bool explains(const SeenPixel& pixel, const Eigen::Vector3d& p, double reach) const {
    const auto near = [&](double depth) { return (point_at(k_, pixel.pixel, depth) - p).norm() <= reach; };
    const auto seen = view_.seen(pixel);
    return !pixel.may_miss && std::all_of(seen.begin(), seen.end(), [&](const Seen& s) {
      return near(s.depth.near) && near(s.depth.far);
    });
  }

  const ObservedPoints& observed_;
  const Intrinsics& k_;
  const SceneView& view_;
  double delta_;
  const CountingRule& rule_;
};

}  // namespace

CostRange cost_range(const ObservedPoints& observed, const Intrinsics& intrinsics, const SceneView& view,
                     const CountingRule& rule) {
  return CostCounter(observed, intrinsics, view, rule).count();
}

}  // namespace perch
