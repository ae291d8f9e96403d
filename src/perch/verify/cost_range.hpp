#pragma once

#include <optional>
#include <vector>

#include "perch/verify/count_range.hpp"
#include "perch/verify/observed_points.hpp"
#include "perch/verify/scene_view.hpp"

namespace perch {

/// The explanation cost of a scene, as far as rounding lets anyone say.
struct CostRange {
  CountRange observed;                ///< J_observed: points of I without a rendered point within delta
  CountRange rendered;                ///< J_rendered: rendered points without a point of I within delta
  std::vector<CountRange> explained;  ///< pixels at which each object is seen and within delta of I

  CountRange total() const { return observed + rendered; }
};

/// What J is counted by.
struct CountingRule {
  double delta = 0.0;           ///< metres, > 0
  bool ignore_missing = false;  ///< rendered points at unknown pixels are left out of R
  bool ignore_points = false;   ///< points of I cost nothing
  /// Where clutter may be in view: rendered points farther than a reading by more than delta are left out of
  /// R, except at this share of the pixels.
  std::optional<double> clutter_weight;
};

/// `explained` counts also what is left out of R.
CostRange cost_range(const ObservedPoints& observed, const Intrinsics& intrinsics, const SceneView& view,
                     const CountingRule& rule);

}  // namespace perch
