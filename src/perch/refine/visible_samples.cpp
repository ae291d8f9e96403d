#include "perch/refine/visible_samples.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace perch {

void visible_samples(const SurfaceSamples& view, const Pose& pose, double origin_z,
                     const DepthPatch* in_front, const Observation& observation, double occlusion,
                     SurfaceSamples& samples, Sight& sight) {
  samples.clear();
  const Intrinsics& intrinsics = observation.intrinsics();
  const Eigen::Isometry3f world_from_model = perch::world_from_model(pose, origin_z).cast<float>();
  const Eigen::Isometry3f camera_from_model =
      (observation.camera().world_from_camera.inverse() * perch::world_from_model(pose, origin_z))
          .cast<float>();
  const float fx = static_cast<float>(intrinsics.fx), fy = static_cast<float>(intrinsics.fy);
  // The centre of the nearest pixel, by cutting off.
  const float cx = static_cast<float>(intrinsics.cx) + 0.5F, cy = static_cast<float>(intrinsics.cy) + 0.5F;
  const float width = static_cast<float>(intrinsics.width), height = static_cast<float>(intrinsics.height);
  const float hidden = static_cast<float>(occlusion);
  for (std::size_t i = 0; i < view.size(); ++i) {
    const Eigen::Vector3f p = camera_from_model * view.point(i);
    if (!(p.z() > 0.0F)) continue;
    const float inverse = 1.0F / p.z();
    const float u = fx * p.x() * inverse + cx, v = fy * p.y() * inverse + cy;
    if (!(u >= 0.0F && v >= 0.0F && u < width && v < height)) continue;
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    if (in_front != nullptr) {
      sight.add(column, row, p.z());
      if (in_front->at_or_none(column, row) < p.z()) continue;
    }
    const float observed = observation.depth(column, row);
    if (observed > 0.0F && p.z() - observed > hidden) continue;
    samples.push_back(world_from_model * view.point(i), world_from_model.linear() * view.normal(i));
  }
}

}  // namespace perch
