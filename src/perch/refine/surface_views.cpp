#include "perch/refine/surface_views.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "perch/render/rasterizer.hpp"

namespace perch {
namespace {

constexpr double bin_width = 10.0 * std::numbers::pi / 180.0;  // a surface turns away slowly
constexpr int image_size = 192;  // pixels: a fine enough step for normals by differences

/// Evenly spread points of a rendering with normals from their neighbours, camera frame.
void sample(const DepthPatch& patch, const RaySlopes& rays, int samples, SurfaceSamples& found) {
  const Window& window = patch.window;
  const double covered = static_cast<double>(patch.covered());
  const int stride = std::max(1, static_cast<int>(std::sqrt(covered / samples)));
  for (int v = window.v0 + 1; v < window.v1 - 1; v += stride)
    for (int u = window.u0 + 1; u < window.u1 - 1; u += stride) {
      const float z = patch.at(u, v);
      if (!(z < no_surface)) continue;
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
      if (length > 0.0F) found.push_back(rays.point(u, v, z), normal / length);
    }
}

}  // namespace

SurfaceViews::SurfaceViews(const ObjectModel& model, double distance, int samples)
    : model_(model),
      distance_(distance),
      samples_(samples),
      azimuths_(1),
      elevations_(static_cast<std::size_t>(std::lround(std::numbers::pi / bin_width))) {
  if (!model.symmetry().is_continuous())
    azimuths_ = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::lround(model.symmetry().period() / bin_width)));
  bins_ = std::make_unique<Bin[]>(azimuths_ * elevations_);
}

SurfaceViews::View SurfaceViews::from(const Eigen::Vector3d& eye, const Pose& pose) const {
  const double dx = eye.x() - pose.x, dy = eye.y() - pose.y;
  const double bearing = std::atan2(dy, dx);
  const double elevation =
      std::atan2(eye.z() - (model_.origin_z() + 0.5 * model_.height()), std::hypot(dx, dy));
  const auto bin_of = [](double share, std::size_t bins) {
    return std::min(bins - 1, static_cast<std::size_t>(std::max(0.0, share * static_cast<double>(bins))));
  };
  const double period = model_.symmetry().is_continuous() ? 0.0 : model_.symmetry().period();
  // Where the camera stands as the object sees it, turned into the first period.
  const double azimuth =
      period > 0.0 ? (bearing - pose.yaw) - period * std::floor((bearing - pose.yaw) / period) : 0.0;
  const std::size_t i = period > 0.0 ? bin_of(azimuth / period, azimuths_) : 0;
  const std::size_t j = bin_of(elevation / std::numbers::pi + 0.5, elevations_);
  Bin& bin = bins_[j * azimuths_ + i];
  std::call_once(bin.made, [&] {
    const auto middle = [](std::size_t k, std::size_t bins) {
      return (static_cast<double>(k) + 0.5) / static_cast<double>(bins);
    };
    make(period * middle(i, azimuths_), std::numbers::pi * (middle(j, elevations_) - 0.5), bin.samples);
  });
  return {bin.samples, bearing - azimuth};
}

/// Renders the model into a small image that it just fits into.
void SurfaceViews::make(double azimuth, double elevation, SurfaceSamples& samples) const {
  const double reach = std::hypot(model_.radius(), 0.5 * model_.height());
  const double distance = std::max(distance_, 1.5 * reach);
  const Eigen::Vector3d middle(0.0, 0.0, 0.5 * model_.height());
  const Eigen::Vector3d outwards(std::cos(elevation) * std::cos(azimuth),
                                 std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  Eigen::Isometry3d model_from_camera = Eigen::Isometry3d::Identity();
  model_from_camera.linear().col(2) = -outwards;
  model_from_camera.linear().col(0) = Eigen::Vector3d(-std::sin(azimuth), std::cos(azimuth), 0.0);
  model_from_camera.linear().col(1) =
      model_from_camera.linear().col(2).cross(model_from_camera.linear().col(0));
  model_from_camera.translation() = middle + distance * outwards;

  constexpr double half = 0.5 * image_size;
  const double focal = (half - 2.0) * std::sqrt(distance * distance - reach * reach) / reach;
  const Intrinsics intrinsics{image_size, image_size, focal, focal, half - 0.5, half - 0.5};
  SurfaceSamples seen;
  sample(Rasterizer(intrinsics).render(model_.mesh(), model_from_camera.inverse()), RaySlopes(intrinsics),
         samples_, seen);
  const Eigen::Isometry3f to_model = model_from_camera.cast<float>();
  for (std::size_t i = 0; i < seen.size(); ++i)
    samples.push_back(to_model * seen.point(i), to_model.linear() * seen.normal(i));
}

}  // namespace perch
