#include "perch/localize/reach.hpp"

#include <algorithm>
#include <limits>

namespace perch {

Image<std::uint8_t> readings_in_reach(const Scene& scene, double table_height, double margin) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest, radius = 0.0;
  for (const SceneModel& model : scene.models) {
    lowest = std::min(lowest, table_height + model.base);
    highest =
        std::max(highest, table_height + model.base + static_cast<double>(model.mesh.bounds().max().z()));
    for (const Eigen::Vector3f& p : model.mesh.vertices)
      radius = std::max(radius, static_cast<double>(p.head<2>().norm()));
  }
  Eigen::AlignedBox3d reach(Eigen::Vector3d(0, 0, lowest - margin), Eigen::Vector3d(0, 0, highest + margin));
  constexpr double anywhere = std::numeric_limits<double>::infinity();
  const Workspace everywhere{-anywhere, anywhere, -anywhere, anywhere};
  const Workspace w = scene.workspace.value_or(everywhere);
  reach.min().head<2>() << w.x_min - radius - margin, w.y_min - radius - margin;
  reach.max().head<2>() << w.x_max + radius + margin, w.y_max + radius + margin;

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
