#pragma once

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

/// \param delta metres, > 0. \param ignore_missing rendered points at unknown pixels are left out of R;
/// `explained` counts them all the same.
CostRange cost_range(const ObservedPoints& observed, const Intrinsics& intrinsics, const SceneView& view,
                     double delta, bool ignore_missing);

}  // namespace perch
