#pragma once

#include "perch/core/pose.hpp"
#include "perch/model/object_model.hpp"

namespace perch {

/// How much objects may share before they collide.
struct CollisionSettings {
  double penetration = 0.010;  ///< metres; noise and thinned meshes make touching objects overlap by this
  double overlap =
      0.35;  ///< share of the smaller solid that may lie inside the other: thin walls have no depth

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

/// True if a surface point of one object lies deeper than `penetration` inside the other's solid, or if more
/// than `overlap` of one solid lies inside the other. The depth is the solid's lower bound, so objects that
/// enter each other by no more than `penetration` don't collide by it; those that do by more than
/// `penetration` + SolidVolume::uncertainty()
/// + sample_radius() always do. Open meshes have no inside.
bool collides(const ObjectModel& a, const Pose& pose_a, const ObjectModel& b, const Pose& pose_b,
              const CollisionSettings& settings);

}  // namespace perch
