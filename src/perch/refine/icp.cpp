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
  in_range("least_matched", least_matched, 0.0, 1.0, "");
  in_range("robust_scale", robust_scale, 1e-6, 1.0, " metres");
  in_range("occlusion", occlusion, 0.0, 10.0, " metres");
}

namespace {

/// A rendered pixel's depth and those of its neighbours.
struct Cross {
  float middle, left, right, up, down;
};

/// \param cross_at gives the cross of pixel (u, v), column i and row j of the samples.
template <typename CrossAt>
void sample(const Window& window, int stride, const CrossAt& cross_at, const DepthPatch* in_front,
            const Observation& observation, const RefineSettings& settings,
            std::vector<SurfaceSample>& samples) {
  const Eigen::Isometry3f world_from_camera = observation.camera().world_from_camera.cast<float>();
  const RaySlopes& rays = observation.rays();
  const float occlusion = static_cast<float>(settings.occlusion);
  for (int v = window.v0 + 1, j = 0; v < window.v1 - 1; v += stride, ++j)
    for (int u = window.u0 + 1, i = 0; u < window.u1 - 1; u += stride, ++i) {
      const Cross cross = cross_at(u, v, i, j);
      const float z = cross.middle;
      if (!(z < no_surface) || (in_front != nullptr && in_front->at_or_none(u, v) < z)) continue;
      const float observed = observation.depth(u, v);
      if (observed > 0.0F && z - observed > occlusion) continue;
      // A neighbour much nearer or farther lies on another surface: its difference says nothing of this one's
      // normal.
      const float jump = 0.05F * z;
      const auto usable = [&](float other) { return std::abs(other - z) < jump; };
      if (!usable(cross.left) || !usable(cross.right) || !usable(cross.up) || !usable(cross.down)) continue;
      const Eigen::Vector3f horizontal = rays.point(u + 1, v, cross.right) - rays.point(u - 1, v, cross.left);
      const Eigen::Vector3f vertical = rays.point(u, v + 1, cross.down) - rays.point(u, v - 1, cross.up);
      const Eigen::Vector3f normal = vertical.cross(horizontal);  // turned to the camera
      const float length = normal.norm();
      if (!(length > 0.0F)) continue;
      samples.push_back(
          {world_from_camera * rays.point(u, v, z), world_from_camera.linear() * (normal / length)});
    }
}

/// The greatest distance of a sample from the object's axis.
double longest_arm(const std::vector<SurfaceSample>& samples, const Pose& pose) {
  const auto x = [&](const SurfaceSample& s) { return static_cast<double>(s.point.x()) - pose.x; };
  const auto y = [&](const SurfaceSample& s) { return static_cast<double>(s.point.y()) - pose.y; };
  double most = 0.0;
  for (const SurfaceSample& s : samples) most = std::max(most, x(s) * x(s) + y(s) * y(s));
  // hypot is exact to the last bit, and slow: only for those that can be the greatest.
  double arm = 0.0;
  for (const SurfaceSample& s : samples)
    if (x(s) * x(s) + y(s) * y(s) >= most * (1.0 - 1e-12)) arm = std::max(arm, std::hypot(x(s), y(s)));
  return arm;
}

}  // namespace

void sample_patch(const DepthPatch& patch, const DepthPatch* in_front, const Observation& observation,
                  const RefineSettings& settings, std::vector<SurfaceSample>& samples) {
  samples.clear();
  const auto cross_at = [&](int u, int v, int, int) -> Cross {
    return {patch.at(u, v), patch.at(u - 1, v), patch.at(u + 1, v), patch.at(u, v - 1), patch.at(u, v + 1)};
  };
  sample(patch.window, sample_stride(patch.window, settings.samples), cross_at, in_front, observation,
         settings, samples);
}

void sample_crosses(const DepthCrosses& crosses, const DepthPatch* in_front, const Observation& observation,
                    const RefineSettings& settings, std::vector<SurfaceSample>& samples) {
  samples.clear();
  const auto cross_at = [&](int, int, int i, int j) -> Cross {
    const float* depth = crosses.at(i, j);
    return {depth[DepthCrosses::middle], depth[DepthCrosses::left], depth[DepthCrosses::right],
            depth[DepthCrosses::up], depth[DepthCrosses::down]};
  };
  sample(crosses.window, crosses.stride, cross_at, in_front, observation, settings, samples);
}

Pose align(const std::vector<SurfaceSample>& samples, const Pose& pose, bool fix_yaw,
           const NearestTable& observed, double reach, const RefineSettings& settings) {
  constexpr double smallest_step =
      5e-5;  // metres, also at the arm's end of a turn: below what the sensor can show
  constexpr double damping =
      1e-2;  // of the points' weight: holds what the visible surface leaves undetermined
  const float reach_squared = static_cast<float>(reach * reach);
  const float scale = static_cast<float>(settings.robust_scale);
  const double arm = longest_arm(samples, pose);
  if (arm == 0.0) return pose;

  const double least = settings.least_matched * static_cast<double>(samples.size());
  Pose moved = pose;
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    // The samples turn about the object's origin by the yaw gained so far, then shift.
    const float c = static_cast<float>(std::cos(moved.yaw - pose.yaw)),
                s = static_cast<float>(std::sin(moved.yaw - pose.yaw));
    Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    double total_weight = 0.0;
    std::size_t matched = 0;
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
      ++matched;
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
    if (total_weight == 0.0 || (iteration == 0 && static_cast<double>(matched) < least)) break;
    normal_matrix.diagonal().array() += damping * total_weight;
    const Eigen::Vector3d step = -normal_matrix.ldlt().solve(gradient);
    moved.x += step.x();
    moved.y += step.y();
    moved.yaw += fix_yaw ? 0.0 : step.z() / arm;
    if (step.norm() < smallest_step) break;
  }
  return moved;
}

double mean_residual(const std::vector<SurfaceSample>& samples, const NearestTable& observed, double limit) {
  if (samples.empty()) return 1.0;
  double sum = 0.0;
  for (const SurfaceSample& sample : samples) {
    const Eigen::Vector3f* q = observed.lookup(sample.point);
    const double e =
        q == nullptr ? limit : std::abs(static_cast<double>(sample.normal.dot(sample.point - *q)));
    sum += std::min(1.0, e / limit);
  }
  return sum / static_cast<double>(samples.size());
}

}  // namespace perch
