#pragma once

#include "perch/core/pose.hpp"
#include "perch/model/object_model.hpp"

namespace perch {

/// True only if a surface point of one object lies deeper than `penetration` (metres) inside the other's
/// solid. The depth is the solid's lower bound, so objects that enter each other by no more than
/// `penetration` never collide; those that do by more than `penetration` + SolidVolume::uncertainty() +
/// sample_radius() always do. Open meshes have no inside.
bool collides(const ObjectModel& a, const Pose& pose_a, const ObjectModel& b, const Pose& pose_b,
              double penetration);

}  // namespace perch
