#include "perch/model/collision.hpp"

#include <cmath>

namespace perch {
namespace {

/// True if a surface sample of `guest` lies deeper than `penetration` in `host`.
bool enters(const ObjectModel& guest, const Pose& guest_pose, const ObjectModel& host, const Pose& host_pose,
            double penetration) {
  const SolidVolume& solid = host.solid();
  const float limit = static_cast<float>(penetration);
  if (!solid.is_solid() || solid.greatest_depth() <= limit) return false;
  const Eigen::Isometry3f host_from_guest =
      (host.world_from_model(host_pose).inverse() * guest.world_from_model(guest_pose)).cast<float>();
  for (const Eigen::Vector3f& p : guest.solid().surface_samples())
    if (solid.depth_lower_bound(host_from_guest * p) > limit) return true;
  return false;
}

}  // namespace

bool collides(const ObjectModel& a, const Pose& pose_a, const ObjectModel& b, const Pose& pose_b,
              double penetration) {
  if (std::hypot(pose_a.x - pose_b.x, pose_a.y - pose_b.y) >= a.radius() + b.radius()) return false;
  if (a.origin_z() + a.height() <= b.origin_z() || b.origin_z() + b.height() <= a.origin_z()) return false;
  return enters(a, pose_a, b, pose_b, penetration) || enters(b, pose_b, a, pose_a, penetration);
}

}  // namespace perch
