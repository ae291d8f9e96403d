#include "camera_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "perch/localize/reach.hpp"

namespace perch::app {
namespace {

constexpr double tilt_scale = 0.1, height_scale = 0.04;  // radians, metres: what a good pose stays well below
constexpr double above_plane = 0.02;  // metres; what objects may stand out over their reach
constexpr double above_plane_share =
    0.025;  // of the plane's distance, so at any scale; nearer readings are its
constexpr double good_fit = 0.5, poor_fit = 0.3, better_by = 2.0;

/// A mistake that would explain what is seen: the camera pose or the depth as they should have been.
struct Mistake {
  std::string key, what, remedy;
  Eigen::Isometry3d world_from_camera;
  double scale = 1.0;  ///< of the depth
};

Eigen::Isometry3d turned(const Eigen::Vector3d& diagonal) {
  Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
  t.linear() = diagonal.asDiagonal();
  return t;
}

/// Optical axes (x right, y down, z forward) seen from a body's (x forward, y left, z up).
Eigen::Isometry3d body_from_optical() {
  Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
  t.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return t;
}

std::vector<Mistake> usual_mistakes(const Eigen::Isometry3d& given) {
  const std::string pose = "camera.world_from_camera";
  const Eigen::Isometry3d inverse = given.inverse(), graphics = turned({1, -1, -1}),
                          body = body_from_optical();
  std::vector<Mistake> all{
      {pose, "maps the other way: it looks like camera_from_world", "give its inverse", inverse},
      {pose, "has the camera's y up and z backwards, as graphics has it",
       "turn the camera's axes to x right, y down, z forward: change the signs of the matrix' second and "
       "third column",
       given * graphics},
      {pose, "has the camera's x forward and z up, as robots have it",
       "turn the camera's axes to x right, y down, z forward: multiply from the right by the "
       "body-from-optical rotation",
       given * body},
      {pose, "maps the other way and has the camera's y up and z backwards",
       "give the inverse, and change the signs of its second and third column", inverse * graphics},
      {pose, "maps the other way and has the camera's x forward and z up",
       "give the inverse, multiplied from the right by the body-from-optical rotation", inverse * body},
      {pose, "has the world's z pointing down",
       "turn the world upside down: change the signs of the matrix' second and third row", graphics * given},
      {pose, "is mirrored to have the world's z pointing down",
       "change the signs of the matrix' first and third row", turned({-1, 1, -1}) * given}};
  constexpr double far_away = 20.0;  // metres; such a camera's pose is in millimetres
  if (given.translation().norm() > far_away) {
    all.push_back({pose, "has its lengths in millimetres", "give the translation in metres", given});
    all.back().world_from_camera.translation() *= 0.001;
  }
  for (const double factor : {10.0, 100.0, 1000.0})
    for (const double scale : {factor, 1.0 / factor})
      all.push_back({"observation.depth_scale",
                     scale < 1.0 ? fmt::format("makes the scene {:g} times too large", factor)
                                 : fmt::format("makes the scene {:g} times too small", factor),
                     scale < 1.0 ? fmt::format("divide it by {:g}", factor)
                                 : fmt::format("multiply it by {:g}", factor),
                     given, scale});
  return all;
}

/// Judges a camera pose by what is known besides: a level plane at the table's height below the camera, and
/// readings within reach of the objects.
class CameraJudge {
 public:
  CameraJudge(const Scene& scene, const std::optional<SupportPlane>& plane) : scene_(scene), plane_(plane) {
    const RaySlopes rays(scene.camera.intrinsics);
    constexpr int step = 5;
    for (int v = 0; v < scene.depth.height(); v += step)
      for (int u = 0; u < scene.depth.width(); u += step) {
        const float z = scene.depth(u, v);
        if (!(z > 0.0F) || (scene.mask && (*scene.mask)(u, v) == 0)) continue;
        const Eigen::Vector3d p = rays.point(u, v, z).cast<double>();
        if (!plane || plane->above(p) > above_plane_share * plane->distance) points_.push_back(p);
      }
  }

  /// Something is known that a pose can be held against.
  bool can_judge() const { return plane_ || scene_.workspace || scene_.table_height; }

  /// From 0, does not fit at all, to 1.
  double fit(const Eigen::Isometry3d& world_from_camera, double scale) const {
    return plane_fit(world_from_camera, scale) * reach_fit(world_from_camera, scale);
  }

 private:
  double plane_fit(const Eigen::Isometry3d& world_from_camera, double scale) const {
    if (!plane_) return 1.0;
    const Eigen::Vector3d up = world_from_camera.linear() * plane_->normal;
    const double tilt = std::acos(std::clamp(up.z(), -1.0, 1.0));
    double off = tilt / tilt_scale;
    double fit = std::exp(-0.5 * off * off);
    if (!scene_.table_height) return fit;
    const double height = world_from_camera.translation().z() - scale * plane_->distance;
    off = (height - *scene_.table_height) / height_scale;
    return fit * std::exp(-0.5 * std::min(off * off, 20.0));
  }

  /// The share of the points that objects can reach; of what stands on a plane a tenth is enough, for other
  /// things may stand there too.
  double reach_fit(const Eigen::Isometry3d& world_from_camera, double scale) const {
    if (points_.empty() || (!scene_.workspace && !scene_.table_height)) return 1.0;
    const Reach reach(scene_, scene_.table_height, above_plane);
    const auto inside = static_cast<double>(std::count_if(points_.begin(), points_.end(), [&](const auto& p) {
      return reach.contains(world_from_camera * Eigen::Vector3d(scale * p));
    }));
    const double share = inside / static_cast<double>(points_.size());
    return std::min(1.0, share / (plane_ ? 0.1 : 0.8));
  }

  const Scene& scene_;
  const std::optional<SupportPlane>& plane_;
  std::vector<Eigen::Vector3d> points_;  ///< camera frame; of I or, where that isn't known, above the plane
};

}  // namespace

std::optional<Warning> check_camera(const Scene& scene, const std::optional<SupportPlane>& plane) {
  if (!scene.has_camera_pose) return std::nullopt;
  const CameraJudge judge(scene, plane);
  if (!judge.can_judge()) return std::nullopt;
  const Eigen::Isometry3d& given = scene.camera.world_from_camera;
  const double as_given = judge.fit(given, 1.0);
  if (as_given >= poor_fit) return std::nullopt;
  const std::vector<Mistake> mistakes = usual_mistakes(given);
  std::vector<double> fits;
  for (const Mistake& mistake : mistakes) fits.push_back(judge.fit(mistake.world_from_camera, mistake.scale));
  const auto best = std::max_element(fits.begin(), fits.end());
  if (*best >= good_fit && *best > better_by * as_given) {
    const Mistake& mistake = mistakes[static_cast<std::size_t>(best - fits.begin())];
    return Warning{mistake.key, mistake.what, mistake.remedy};
  }
  return Warning{
      "camera.world_from_camera",
      "doesn't fit the readings: with it the table is not level at its height, or nothing observed lies in "
      "reach of the objects",
      "check the calibration, table.height and workspace"};
}

}  // namespace perch::app
