#include "perch/observation/cloud_depth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace perch {
namespace {

bool is_reading(const Eigen::Vector3d& p) {
  return p.allFinite() && !p.isZero(0.0);
}

/// Calls visit(number, point in the camera frame) for each so-many-th reading.
template <typename Visit>
void for_each_reading(const CloudPoints& points, const Eigen::Affine3d& camera_from_points, std::size_t every,
                      const Visit& visit) {
  std::size_t readings = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_reading(points[i]) && readings++ % every == 0) visit(i, camera_from_points * points[i]);
}

Eigen::Vector2d pixel_of(const Eigen::Vector3d& p, const Intrinsics& k) {
  return {k.fx * p.x() / p.z() + k.cx, k.fy * p.y() / p.z() + k.cy};
}

/// The line value = slope * at + offset by least squares.
class Line {
 public:
  void add(double at, double value) {
    n_ += 1.0;
    a_ += at;
    v_ += value;
    aa_ += at * at;
    av_ += at * value;
  }
  double slope() const { return (n_ * av_ - a_ * v_) / (n_ * aa_ - a_ * a_); }
  double offset() const { return (v_ - slope() * a_) / n_; }

 private:
  double n_ = 0.0, a_ = 0.0, v_ = 0.0, aa_ = 0.0, av_ = 0.0;
};

}  // namespace

double median_pixel_error(const CloudPoints& points, const Eigen::Affine3d& camera_from_points,
                          const Intrinsics& intrinsics, std::size_t every) {
  const auto width = static_cast<std::size_t>(intrinsics.width);
  std::vector<double> errors;
  for_each_reading(points, camera_from_points, every, [&](std::size_t i, const Eigen::Vector3d& p) {
    const Eigen::Vector2d own(static_cast<double>(i % width), static_cast<double>(i / width));
    const double error = p.z() > 0.0 ? (pixel_of(p, intrinsics) - own).norm() : INFINITY;
    errors.push_back(std::isfinite(error) ? error : INFINITY);
  });
  if (errors.empty()) return INFINITY;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

DepthImage depth_of_organized(const CloudPoints& points, const Eigen::Affine3d& camera_from_points,
                              const Intrinsics& intrinsics) {
  DepthImage depth(intrinsics.width, intrinsics.height);
  for_each_reading(points, camera_from_points, 1, [&](std::size_t i, const Eigen::Vector3d& p) {
    const auto z = static_cast<float>(p.z());
    if (z > 0.0F && std::isfinite(z)) depth[i] = z;
  });
  return depth;
}

CloudProjection project_cloud(const CloudPoints& points, const Eigen::Affine3d& camera_from_points,
                              const Intrinsics& intrinsics, std::size_t every) {
  CloudProjection out{DepthImage(intrinsics.width, intrinsics.height)};
  for_each_reading(points, camera_from_points, every, [&](std::size_t, const Eigen::Vector3d& p) {
    ++out.readings;
    const auto z = static_cast<float>(p.z());
    if (!(z > 0.0F && std::isfinite(z))) return;
    const Eigen::Vector2d at = (pixel_of(p, intrinsics).array() + 0.5).floor();
    if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < intrinsics.width && at.y() < intrinsics.height)) return;
    ++out.in_view;
    float& nearest = out.depth(static_cast<int>(at.x()), static_cast<int>(at.y()));
    nearest = nearest == 0.0F ? z : std::min(nearest, z);
  });
  return out;
}

Intrinsics fitted_intrinsics(const CloudPoints& points, const Intrinsics& size) {
  const auto width = static_cast<std::size_t>(size.width);
  Line columns, rows;
  for_each_reading(points, Eigen::Affine3d::Identity(), 1, [&](std::size_t i, const Eigen::Vector3d& p) {
    if (!(p.z() > 0.0)) return;
    columns.add(p.x() / p.z(), static_cast<double>(i % width));
    rows.add(p.y() / p.z(), static_cast<double>(i / width));
  });
  return {size.width, size.height, columns.slope(), rows.slope(), columns.offset(), rows.offset()};
}

}  // namespace perch
