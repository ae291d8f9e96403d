#include "perch/refine/icp.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "perch/core/error.hpp"

namespace perch {

void RefineSettings::check() const {
  const auto in_range = [](const char* field, double value, double low, double high, const char* unit) {
    if (!(value >= low && value <= high))
      throw InvalidSetting(
          fmt::format("refine.{} is {}; it must lie between {} and {}{}", field, value, low, high, unit));
  };
  if (reach) in_range("reach", *reach, 1e-6, largest_reach, " metres");
  in_range("rounds", rounds, 1, 100, "");
  in_range("iterations", iterations, 1, 1000, "");
  in_range("samples", samples, 10, 1e6, "");
  in_range("robust_scale", robust_scale, 1e-6, 1.0, " metres");
  in_range("occlusion", occlusion, 0.0, 10.0, " metres");
}

void sample_patch(const DepthPatch& patch, const DepthPatch* in_front, const Observation& observation,
                  const RefineSettings& settings, std::vector<SurfaceSample>& samples) {
  samples.clear();
  const Window& window = patch.window;
  if (window.width() < 3 || window.height() < 3) return;
  const Eigen::Isometry3f world_from_camera = observation.camera().world_from_camera.cast<float>();
  const RaySlopes& rays = observation.rays();
  const double area = static_cast<double>(window.width()) * window.height();
  const int stride = std::max(1, static_cast<int>(std::sqrt(area / settings.samples)));
  const float occlusion = static_cast<float>(settings.occlusion);
  for (int v = window.v0 + 1; v < window.v1 - 1; v += stride)
    for (int u = window.u0 + 1; u < window.u1 - 1; u += stride) {
      const float z = patch.at(u, v);
      if (!(z < no_surface) || (in_front != nullptr && in_front->at_or_none(u, v) < z)) continue;
      const float observed = observation.depth(u, v);
      if (observed > 0.0F && z - observed > occlusion) continue;
      const float left = patch.at(u - 1, v), right = patch.at(u + 1, v), up = patch.at(u, v - 1),
                  down = patch.at(u, v + 1);
      // A neighbour much nearer or farther lies on another surface: its difference says nothing of this one's
      // normal.
      const float jump = 0.05F * z;
      const auto usable = [&](float other) { return std::abs(other - z) < jump; };
      if (!usable(left) || !usable(right) || !usable(up) || !usable(down)) continue;
      const Eigen::Vector3f horizontal = rays.point(u + 1, v, right) - rays.point(u - 1, v, left);
      const Eigen::Vector3f vertical = rays.point(u, v + 1, down) - rays.point(u, v - 1, up);
      const Eigen::Vector3f normal = vertical.cross(horizontal);  // turned to the camera
      const float length = normal.norm();
      if (!(length > 0.0F)) continue;
      samples.push_back(
          {world_from_camera * rays.point(u, v, z), world_from_camera.linear() * (normal / length)});
    }
}

Pose align(const std::vector<SurfaceSample>& samples, const Pose& pose, bool fix_yaw,
           const NearestTable& observed, double reach, const RefineSettings& settings) {
  constexpr double smallest_step =
      5e-5;  // metres, also at the arm's end of a turn: below what the sensor can show
  constexpr double damping =
      1e-2;  // of the points' weight: holds what the visible surface leaves undetermined
  const float reach_squared = static_cast<float>(reach * reach);
  const float scale = static_cast<float>(settings.robust_scale);
  double arm = 0.0;
  for (const SurfaceSample& s : samples)
    arm = std::max(arm, std::hypot(static_cast<double>(s.point.x()) - pose.x,
                                   static_cast<double>(s.point.y()) - pose.y));
  if (arm == 0.0) return pose;

  Pose moved = pose;
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    // The samples turn about the object's origin by the yaw gained so far, then shift.
    const float c = static_cast<float>(std::cos(moved.yaw - pose.yaw)),
                s = static_cast<float>(std::sin(moved.yaw - pose.yaw));
    Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    double total_weight = 0.0;
    for (const SurfaceSample& sample : samples) {
      const float ax = sample.point.x() - static_cast<float>(pose.x),
                  ay = sample.point.y() - static_cast<float>(pose.y);
      const float rx = c * ax - s * ay, ry = s * ax + c * ay;  // from the origin to the point
      const Eigen::Vector3f p(rx + static_cast<float>(moved.x), ry + static_cast<float>(moved.y),
                              sample.point.z());
      const Eigen::Vector3f* q = observed.lookup(p);
      if (q == nullptr) continue;
      const Eigen::Vector3f difference = p - *q;
      if (!(difference.squaredNorm() <= reach_squared)) continue;
      const float nx = c * sample.normal.x() - s * sample.normal.y(),
                  ny = s * sample.normal.x() + c * sample.normal.y();
      const float e = nx * difference.x() + ny * difference.y() + sample.normal.z() * difference.z();
      const double weight = 1.0 / (1.0 + std::abs(e) / scale);
      // de / d(x, y, yaw); yaw in units of the arm, so that all three are metres.
      const Eigen::Vector3d jacobian(nx, ny, fix_yaw ? 0.0 : (ny * rx - nx * ry) / arm);
      normal_matrix += weight * jacobian * jacobian.transpose();
      gradient += weight * static_cast<double>(e) * jacobian;
      total_weight += weight;
    }
    if (total_weight == 0.0) break;
    normal_matrix.diagonal().array() += damping * total_weight;
    const Eigen::Vector3d step = -normal_matrix.ldlt().solve(gradient);
    moved.x += step.x();
    moved.y += step.y();
    moved.yaw += fix_yaw ? 0.0 : step.z() / arm;
    if (step.norm() < smallest_step) break;
  }
  return moved;
}

}  // namespace perch
