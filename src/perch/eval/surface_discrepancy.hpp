#pragma once

#include <array>
#include <cstddef>

#include "perch/core/camera.hpp"
#include "perch/core/image.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {

/// The misalignment tolerances tau of VSD, and the shares of the diameter that MSSD is held against: 5 % to
/// 50 % in steps of 5 % (BOP Challenge 2019).
inline constexpr std::size_t tolerance_count = 10;
constexpr double tolerance(std::size_t i) {
  return 0.05 * static_cast<double>(i + 1);
}

/// VSD at each tolerance (Hodan et al. 2018, as in the BOP Challenge 2019): of the pixels at which the object
/// is visible at either pose, the share at which it is not visible at both, or its distances from the
/// camera's centre differ by tau times the diameter or more. Visible at the truth: rendered no farther than
/// `visibility_tolerance` behind the reading, or where there is no reading; visible at the estimate:
/// likewise, or rendered where the truth is visible. 1 where it is visible nowhere. \param estimate,truth the
/// object alone at both poses. \param observed the whole depth image, metres. \param diameter metres, > 0.
/// \param visibility_tolerance BOP's delta, metres.
std::array<double, tolerance_count> surface_discrepancy(const DepthPatch& estimate, const DepthPatch& truth,
                                                        const DepthImage& observed, const RaySlopes& slopes,
                                                        double diameter, double visibility_tolerance = 0.015);

}  // namespace perch
