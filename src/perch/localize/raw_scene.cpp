#include "perch/localize/raw_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "perch/core/error.hpp"
#include "perch/localize/reach.hpp"
#include "perch/observation/raw_labels.hpp"

namespace perch {
namespace {

constexpr double farthest_origin = 3.0;  // metres along the optical axis
constexpr double cell = 0.04;            // metres, of the map of what is seen of the table
constexpr double table_border = 0.06;    // metres that objects may stand out over what is seen of it

SupportPlane plane_of(const Scene& scene, const PlaneSettings& settings) {
  PlaneSearch search;
  search.seed = settings.seed;
  if (scene.has_camera_pose)
    search.up = scene.camera.world_from_camera.linear().transpose() * Eigen::Vector3d::UnitZ();
  if (auto plane = find_support_plane(scene.depth, scene.camera.intrinsics, search)) return *plane;
  if (!scene.has_camera_pose)
    throw InputError(
        "observation.background: no support plane is seen in the depth image; give camera.world_from_camera "
        "and "
        "table.height, or show more of the table");
  if (!scene.table_height)
    throw InputError(
        "observation.background: no level plane is seen in the depth image; check camera.world_from_camera, "
        "or give "
        "table.height");
  // Where the pose and the height say it is.
  SupportPlane plane;
  plane.normal = *search.up;
  plane.distance = scene.camera.world_from_camera.translation().z() - *scene.table_height;
  return plane;
}

/// The world that a plane defines.
Eigen::Isometry3d world_of(const SupportPlane& plane) {
  const Eigen::Vector3d z = plane.normal;
  Eigen::Vector3d x = Eigen::Vector3d::UnitX() - z.x() * z;
  if (x.norm() < 1e-3) x = Eigen::Vector3d::UnitY() - z.y() * z;
  x.normalize();
  const double along = z.z() < 0.0 ? -plane.distance / z.z() : 2.0 * farthest_origin;
  const Eigen::Vector3d origin =
      along <= farthest_origin ? Eigen::Vector3d(0.0, 0.0, along) : Eigen::Vector3d(-plane.distance * z);
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
  camera_from_world.linear() << x, z.cross(x), z;
  camera_from_world.translation() = origin;
  return camera_from_world.inverse();
}

/// The largest connected part of the table that is seen, a rectangle along x and y of the world.
Workspace seen_table(const Scene& scene, const SupportPlane& plane) {
  const RaySlopes rays(scene.camera.intrinsics);
  std::map<std::pair<int, int>, int> counts;
  for (int v = 0; v < scene.depth.height(); v += 2)
    for (int u = 0; u < scene.depth.width(); u += 2) {
      const float z = scene.depth(u, v);
      if (!(z > 0.0F)) continue;
      const Eigen::Vector3d p = rays.point(u, v, z).cast<double>();
      // What stands on it hides it.
      if (plane.above(p) < -plane_tolerance(z) || plane.above(p) > 0.3) continue;
      const Eigen::Vector3d w = scene.camera.world_from_camera * p;
      const bool on_it = std::abs(plane.above(p)) <= plane_tolerance(z);
      int& count =
          counts[{static_cast<int>(std::floor(w.x() / cell)), static_cast<int>(std::floor(w.y() / cell))}];
      count += on_it ? 1 : 0;
    }
  std::set<std::pair<int, int>> open;
  for (const auto& [place, count] : counts)
    if (count >= 2) open.insert(place);
  std::vector<std::pair<int, int>> largest;
  while (!open.empty()) {
    std::vector<std::pair<int, int>> part{*open.begin()};
    open.erase(open.begin());
    for (std::size_t i = 0; i < part.size(); ++i)
      for (int dx = -2; dx <= 2; ++dx)  // over the gap that an edge of an object makes
        for (int dy = -2; dy <= 2; ++dy)
          if (const auto next = open.find({part[i].first + dx, part[i].second + dy}); next != open.end()) {
            part.push_back(*next);
            open.erase(next);
          }
    if (part.size() > largest.size()) largest = std::move(part);
  }
  Workspace seen{0.0, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < largest.size(); ++i) {
    const double x = cell * largest[i].first, y = cell * largest[i].second;
    if (i == 0) seen = {x, x, y, y};
    seen = {std::min(seen.x_min, x), std::max(seen.x_max, x + cell), std::min(seen.y_min, y),
            std::max(seen.y_max, y + cell)};
  }
  return seen;
}

/// Height of the plane in the world at a place.
double height_at(const Scene& scene, const SupportPlane& plane, double x, double y) {
  const Eigen::Vector3d normal = scene.camera.world_from_camera.linear() * plane.normal;
  const double offset = plane.distance - normal.dot(scene.camera.world_from_camera.translation());
  return -(offset + normal.x() * x + normal.y() * y) / normal.z();
}

}  // namespace

Scene without_table(Scene scene, const PlaneSettings& settings) {
  if (!scene.has_camera_pose && scene.table_height)
    throw InputError(
        "table.height: is given without camera.world_from_camera, in a world that only that defines; give "
        "both, or "
        "leave out both");
  EstimatedSupport support{plane_of(scene, settings), !scene.has_camera_pose, true};
  if (!scene.has_camera_pose) scene.camera.world_from_camera = world_of(support.plane);
  scene.has_camera_pose = true;

  const Workspace table = seen_table(scene, support.plane);
  const Workspace at = scene.workspace.value_or(table);
  const double seen = support.camera ? 0.0
                                     : height_at(scene, support.plane, 0.5 * (at.x_min + at.x_max),
                                                 0.5 * (at.y_min + at.y_max));
  support.height = !scene.table_height || std::abs(seen - *scene.table_height) <= settings.height_range;
  if (support.height) scene.table_height = seen;

  std::optional<Eigen::AlignedBox2d> on_table;
  if (!scene.workspace)
    on_table = Eigen::AlignedBox2d(Eigen::Vector2d(table.x_min - table_border, table.y_min - table_border),
                                   Eigen::Vector2d(table.x_max + table_border, table.y_max + table_border));
  Reach reach(scene, scene.table_height, reading_noise);
  if (on_table) reach.limit(*on_table);
  const Eigen::Isometry3d& world_from_camera = scene.camera.world_from_camera;
  const Image<RawLabel> labels = label_raw(
      scene.depth, scene.camera.intrinsics, support.plane,
      [&](const Eigen::Vector3d& p) { return reach.contains(world_from_camera * p); },
      [&](const Eigen::Vector3d& p) {
        return !reach.is_behind(world_from_camera.translation(), world_from_camera * p);
      });
  Image<std::uint8_t> mask(scene.depth.width(), scene.depth.height(), 0);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == RawLabel::object && (!scene.mask || (*scene.mask)[i] != 0)) mask[i] = 255;
    // Where things may stand that no model describes, what is in front hides objects; else it says nothing.
    if (labels[i] == RawLabel::unknown || (labels[i] == RawLabel::foreground && !scene.clutter))
      scene.depth[i] = 0.0F;
  }
  if (std::none_of(mask.data().begin(), mask.data().end(), [](std::uint8_t m) { return m != 0; }))
    throw InputError(
        "observation.background: nothing stands on the support plane within reach of the models; check "
        "workspace, "
        "observation.depth_scale and camera.world_from_camera");
  scene.mask = std::move(mask);
  scene.background = Background::removed;
  scene.support = support;
  return scene;
}

}  // namespace perch
