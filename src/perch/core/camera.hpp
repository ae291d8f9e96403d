#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "perch/core/image.hpp"

namespace perch {

/// A pinhole camera without distortion; optical frame x right, y down, z forward; pixel centres at integers.
struct Intrinsics {
  int width = 0;    ///< pixels
  int height = 0;   ///< pixels
  double fx = 0.0;  ///< pixels
  double fy = 0.0;  ///< pixels
  double cx = 0.0;  ///< pixels
  double cy = 0.0;  ///< pixels

  Window window() const { return {0, 0, width, height}; }
  /// Throws InvalidSetting naming the field: size outside 1..16384, focal length not > 0, anything not
  /// finite.
  void check() const;
};

/// Intrinsics and where the camera stands.
struct Camera {
  Intrinsics intrinsics;
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
};

/// The slopes of the pixels' rays, in float: pixel (u, v) at depth z is the point (x[u] z, y[v] z, z) in the
/// camera frame. Every point of a depth image is made by this one rule, so that counts agree everywhere to
/// the bit.
class RaySlopes {
 public:
  RaySlopes() = default;
  explicit RaySlopes(const Intrinsics& intrinsics);

  float x(int u) const { return x_[static_cast<std::size_t>(u)]; }
  float y(int v) const { return y_[static_cast<std::size_t>(v)]; }
  Eigen::Vector3f point(int u, int v, float depth) const { return {x(u) * depth, y(v) * depth, depth}; }

 private:
  std::vector<float> x_, y_;
};

}  // namespace perch
