#pragma once

#include <vector>

#include "perch/candidates/problem.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {

/// How exact the monotone condition is. The paper's is n = t = 0, which one pixel of depth noise breaks.
struct MonotoneSettings {
  double depth_tolerance = 0.005;  ///< t, metres: a successor may cover any rendered pixel by this much
  int pixel_tolerance = 30;        ///< n: and this many by any depth

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

/// True if the patch covers at most n pixels of the composite by more than t, so that adding it keeps the
/// order monotone: R_j is a subset of R_{j+1} up to the tolerance. Only pixels that count in R take part.
bool keeps_monotone(const ExplanationCost& cost, const DepthPatch& composite, const DepthPatch& patch,
                    const MonotoneSettings& settings);

/// True if some order of these objects is monotone at every step. Tries the nearest first; where that fails
/// it searches the orders, each set of placed objects once.
bool monotone_order_exists(const ExplanationCost& cost, const std::vector<DepthPatch>& patches,
                           const MonotoneSettings& settings);

}  // namespace perch
