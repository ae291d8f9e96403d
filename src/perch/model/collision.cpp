#include "perch/model/collision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "perch/core/error.hpp"

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

/// True if more than `share` of the guest's solid lies inside the host's.
bool fills(const ObjectModel& guest, const Pose& guest_pose, const ObjectModel& host, const Pose& host_pose,
           double share) {
  const auto& samples = guest.solid().interior_samples();
  if (!host.solid().is_solid() || samples.empty()) return false;
  const Eigen::Isometry3f host_from_guest =
      (host.world_from_model(host_pose).inverse() * guest.world_from_model(guest_pose)).cast<float>();
  const auto inside = std::count_if(samples.begin(), samples.end(), [&](const Eigen::Vector3f& p) {
    return host.solid().signed_distance(host_from_guest * p) > 0.0F;
  });
  return static_cast<double>(inside) > share * static_cast<double>(samples.size());
}

}  // namespace

void CollisionSettings::check() const {
  if (!(penetration >= 0.0 && penetration <= 1.0))
    throw InvalidSetting(
        fmt::format("collision.penetration is {}; it must lie between 0 and 1 metre", penetration));
  if (!(overlap > 0.0 && overlap <= 1.0))
    throw InvalidSetting(fmt::format("collision.overlap is {}; it must lie above 0 and up to 1", overlap));
}

bool collides(const ObjectModel& a, const Pose& pose_a, const ObjectModel& b, const Pose& pose_b,
              const CollisionSettings& settings) {
  if (std::hypot(pose_a.x - pose_b.x, pose_a.y - pose_b.y) >= a.radius() + b.radius()) return false;
  if (a.origin_z() + a.height() <= b.origin_z() || b.origin_z() + b.height() <= a.origin_z()) return false;
  return enters(a, pose_a, b, pose_b, settings.penetration) ||
         enters(b, pose_b, a, pose_a, settings.penetration) ||
         fills(a, pose_a, b, pose_b, settings.overlap) || fills(b, pose_b, a, pose_a, settings.overlap);
}

}  // namespace perch
