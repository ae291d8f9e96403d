#pragma once

#include <algorithm>

#include "perch/core/pose.hpp"
#include "perch/observation/observation.hpp"
#include "perch/refine/surface_samples.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {

/// Where a composite was looked at: one with no surface in `window` nearer than `farthest` changes nothing.
struct Sight {
  Window window;
  float farthest = 0.0F;  ///< metres

  void add(int u, int v, float z) {
    window = bounding(window, {u, v, u + 1, v + 1});
    farthest = std::max(farthest, z);
  }
};

/// The samples of an object that stands at a pose, world frame, but for those out of view and those that the
/// observation shows to be hidden. Written into `samples`, whose memory is reused. \param view its samples,
/// model frame. \param pose with the view's yaw. \param origin_z height of the model's origin, metres. \param
/// in_front rendered surfaces that hide it (the parent scene), or nullptr. \param occlusion a point this far
/// behind the observed one is hidden, metres. \param sight where `in_front` was looked at is added.
void visible_samples(const SurfaceSamples& view, const Pose& pose, double origin_z,
                     const DepthPatch* in_front, const Observation& observation, double occlusion,
                     SurfaceSamples& samples, Sight& sight);

}  // namespace perch
