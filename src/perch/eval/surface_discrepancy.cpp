#include "perch/eval/surface_discrepancy.hpp"

#include <cmath>
#include <cstdint>

namespace perch {

std::array<double, tolerance_count> surface_discrepancy(const DepthPatch& estimate, const DepthPatch& truth,
                                                        const DepthImage& observed, const RaySlopes& slopes,
                                                        double diameter, double visibility_tolerance) {
  std::int64_t in_either = 0;
  std::array<std::int64_t, tolerance_count> wrong{};
  const Window window = bounding(estimate.window, truth.window);
  for (int v = window.v0; v < window.v1; ++v)
    for (int u = window.u0; u < window.u1; ++u) {
      const float estimated = estimate.at_or_none(u, v), true_depth = truth.at_or_none(u, v);
      // BOP compares distances from the camera's centre, not depths.
      const double length =
          std::hypot(1.0, static_cast<double>(slopes.x(u)), static_cast<double>(slopes.y(v)));
      const double reading = static_cast<double>(observed(u, v));
      const auto is_visible = [&](float depth) {
        return depth < no_surface &&
               (!(reading > 0.0) || (static_cast<double>(depth) - reading) * length <= visibility_tolerance);
      };
      const bool at_truth = is_visible(true_depth);
      const bool at_estimate = is_visible(estimated) || (at_truth && estimated < no_surface);
      if (!at_truth && !at_estimate) continue;
      ++in_either;
      const double apart =
          at_truth && at_estimate
              ? std::abs(static_cast<double>(estimated) - static_cast<double>(true_depth)) * length / diameter
              : INFINITY;
      for (std::size_t i = 0; i < tolerance_count; ++i) wrong[i] += apart >= tolerance(i);
    }
  std::array<double, tolerance_count> discrepancy;
  for (std::size_t i = 0; i < tolerance_count; ++i)
    discrepancy[i] = in_either == 0 ? 1.0 : static_cast<double>(wrong[i]) / static_cast<double>(in_either);
  return discrepancy;
}

}  // namespace perch
