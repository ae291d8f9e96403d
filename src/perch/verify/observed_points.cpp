#include "perch/verify/observed_points.hpp"

#include <cmath>

namespace perch {
namespace {

std::vector<Eigen::Vector3d> points_of(const Camera& camera, const DepthImage& depth,
                                       const std::optional<Image<std::uint8_t>>& mask) {
  std::vector<Eigen::Vector3d> points;
  for (std::uint32_t i = 0; i < depth.size(); ++i)
    if (std::isfinite(depth[i]) && depth[i] > 0.0F && (!mask || (*mask)[i] != 0))
      points.push_back(point_at(camera.intrinsics, i, depth[i]));
  return points;
}

}  // namespace

ObservedPoints::ObservedPoints(const Camera& camera, const DepthImage& depth,
                               const std::optional<Image<std::uint8_t>>& mask)
    : points_(points_of(camera, depth, mask)),
      unknown_(depth.size(), 0),
      readings_(depth.size(), 0.0F),
      tree_(points_) {
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (std::isfinite(depth[i]) && depth[i] > 0.0F) readings_[i] = depth[i];
  if (!mask) return;
  for (std::size_t i = 0; i < depth.size(); ++i) unknown_[i] = !(std::isfinite(depth[i]) && depth[i] > 0.0F);
}

Eigen::Vector3d point_at(const Intrinsics& k, std::uint32_t pixel, double depth) {
  const auto width = static_cast<std::uint32_t>(k.width);
  return {(pixel % width - k.cx) / k.fx * depth, (pixel / width - k.cy) / k.fy * depth, depth};
}

double distance_rounding(const Eigen::Vector3d& p, double delta) {
  // Each coordinate is a slope times a depth, both rounded: 1.2e-7 of it, for either point.
  return 2.5e-7 * (p.norm() + delta);
}

}  // namespace perch
