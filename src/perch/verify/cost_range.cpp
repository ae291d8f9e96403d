#include "perch/verify/cost_range.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace perch {
namespace {

/// What is known of the points in a range of depths: each lies within delta of I, none does, or it depends on
/// where.
enum class Near { all, none, some };

class CostCounter {
 public:
  CostCounter(const ObservedPoints& observed, const Intrinsics& intrinsics, const SceneView& view,
              double delta, bool ignore_missing)
      : observed_(observed), k_(intrinsics), view_(view), delta_(delta), ignore_missing_(ignore_missing) {}

  CostRange count() {
    CostRange cost;
    cost.explained.resize(view_.visible().size());
    for (const SeenPixel& pixel : view_.pixels()) count_rendered(pixel, cost);
    count_observed(cost);
    return cost;
  }

 private:
  bool counts(const SeenPixel& pixel) const { return !ignore_missing_ || !observed_.is_unknown(pixel.pixel); }

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
    bool all_near = true, none_near = true;
    const auto seen = view_.seen(pixel);
    for (auto s = seen.begin(); s != seen.end();) {
      const std::uint32_t object = s->object;
      bool all = true, none = true;  // of this object's ranges
      for (; s != seen.end() && s->object == object; ++s) {
        const Near near = near_observed(pixel.pixel, s->depth);
        all = all && near == Near::all;
        none = none && near == Near::none;
      }
      cost.explained[object].add(all && view_.is_certain(pixel, object), !none);
      all_near = all_near && all;
      none_near = none_near && none;
    }
    if (counts(pixel)) cost.rendered.add(none_near && !pixel.may_miss, !all_near);
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
  bool ignore_missing_;
};

}  // namespace

CostRange cost_range(const ObservedPoints& observed, const Intrinsics& intrinsics, const SceneView& view,
                     double delta, bool ignore_missing) {
  return CostCounter(observed, intrinsics, view, delta, ignore_missing).count();
}

}  // namespace perch
