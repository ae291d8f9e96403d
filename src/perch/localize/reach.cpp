#include "perch/localize/reach.hpp"

#include <algorithm>
#include <limits>

namespace perch {

Reach::Reach(const Scene& scene, const std::optional<double>& table_height, double margin) {
  constexpr double anywhere = std::numeric_limits<double>::infinity();
  double foot = anywhere, top = -anywhere, radius = 0.0;
  for (const SceneModel& model : scene.models) {
    foot = std::min(foot, model.base);
    top = std::max(top, model.base + static_cast<double>(model.mesh.bounds().max().z()));
    for (const Eigen::Vector3f& p : model.mesh.vertices)
      radius = std::max(radius, static_cast<double>(p.head<2>().norm()));
  }
  const Workspace w = scene.workspace.value_or(Workspace{-anywhere, anywhere, -anywhere, anywhere});
  const double aside = radius + margin;
  box_.min() << w.x_min - aside, w.y_min - aside, table_height ? *table_height + foot - margin : -anywhere;
  box_.max() << w.x_max + aside, w.y_max + aside, table_height ? *table_height + top + margin : anywhere;
}

Image<std::uint8_t> readings_in_reach(const Scene& scene, double table_height, double margin) {
  const Reach reach(scene, table_height, margin);
  const RaySlopes rays(scene.camera.intrinsics);
  Image<std::uint8_t> mask(scene.depth.width(), scene.depth.height(), 0);
  for (int v = 0; v < mask.height(); ++v)
    for (int u = 0; u < mask.width(); ++u) {
      const float z = scene.depth(u, v);
      if (!(z > 0.0F) || (scene.mask && (*scene.mask)(u, v) == 0)) continue;
      if (reach.contains(scene.camera.world_from_camera * rays.point(u, v, z).cast<double>()))
        mask(u, v) = 255;
    }
  return mask;
}

}  // namespace perch
