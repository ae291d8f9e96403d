#pragma once

#include <cstdint>
#include <functional>

#include "perch/core/camera.hpp"
#include "perch/core/image.hpp"
#include "perch/observation/support_plane.hpp"

namespace perch {

/// What the readings of a raw depth image tell of each pixel.
enum class RawLabel : std::uint8_t {
  unknown,     ///< no reading, or one that can't be trusted
  object,      ///< stands on the plane, within reach
  background,  ///< the plane, what lies below it, and what is out of reach behind where objects can stand
  foreground   ///< out of reach in front of where objects can stand: says nothing of what is behind
};

/// Labels a raw depth image.
///
/// Not trusted are mixed pixels, whose depth lies between that of a nearer and a farther surface beside them
/// and which hardly any neighbour continues, and small groups of readings that hang on nothing. A surface
/// that stands on the plane counts down to where it can't be told from the plane's noise, and next to what
/// certainly stands there a little further. \param in_reach whether a point (camera frame) can be an
/// object's. \param behind whether a point out of reach lies behind where objects can stand, so that its ray
/// is seen to be free.
Image<RawLabel> label_raw(const DepthImage& depth, const Intrinsics& intrinsics, const SupportPlane& plane,
                          const std::function<bool(const Eigen::Vector3d&)>& in_reach,
                          const std::function<bool(const Eigen::Vector3d&)>& behind);

}  // namespace perch
