#include "perch/localize/reach.hpp"

#include <algorithm>
#include <limits>
#include <utility>

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

bool Reach::is_behind(const Eigen::Vector3d& eye, const Eigen::Vector3d& p) const {
  double first = 0.0, last = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double way = p[axis] - eye[axis];
    double a = (box_.min()[axis] - eye[axis]) / way, b = (box_.max()[axis] - eye[axis]) / way;
    if (way == 0.0) {
      if (eye[axis] < box_.min()[axis] || eye[axis] > box_.max()[axis]) return false;
      continue;
    }
    if (a > b) std::swap(a, b);
    first = std::max(first, a);
    last = std::min(last, b);
  }
  return first <= last && first > 1.0;
}

void Reach::limit(const Eigen::AlignedBox2d& place) {
  box_.min().head<2>() = box_.min().head<2>().cwiseMax(place.min());
  box_.max().head<2>() = box_.max().head<2>().cwiseMin(place.max());
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
