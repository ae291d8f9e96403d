#pragma once

#include "perch/core/image.hpp"
#include "perch/cost/cost_settings.hpp"
#include "perch/observation/observation.hpp"

namespace perch {

/// True at the share of all pixels at which a rendered point hidden by clutter is charged: the one of a
/// pattern of 8 x 8 pixels that is nearest to `weight`, spread evenly (Bayer 1973). Counts stay whole so.
bool charged_by_clutter(int u, int v, double weight);

/// Which rendered points belong to R: those no farther than a depth of their pixel. None at unknown pixels
/// where these are ignored; none hidden behind a nearer reading by more than delta where clutter may do that,
/// except at pixels that charge for it. What is hidden behind a point left out is left out too, so it makes
/// no difference whether objects are put together before or after.
class CountedDepths {
 public:
  CountedDepths(const Observation& observation, const CostSettings& settings);

  /// True where every rendered point counts.
  bool everywhere() const { return farthest_.empty(); }
  bool counts(int u, int v, float z) const { return farthest_.empty() || z <= farthest_(u, v); }

 private:
  Image<float> farthest_;  ///< empty where every rendered point counts
};

}  // namespace perch
