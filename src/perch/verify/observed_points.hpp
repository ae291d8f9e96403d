#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "perch/core/camera.hpp"
#include "perch/core/image.hpp"
#include "perch/verify/kd_tree.hpp"

namespace perch {

/// I, the observed points, in double: one for each pixel that has a reading and a non-zero mask.
class ObservedPoints {
 public:
  /// \param depth metres, 0 = no reading. \param mask may be absent: every reading then counts.
  ObservedPoints(const Camera& camera, const DepthImage& depth,
                 const std::optional<Image<std::uint8_t>>& mask);

  const std::vector<Eigen::Vector3d>& points() const { return points_; }  ///< camera frame, row by row
  const KdTree& tree() const { return tree_; }
  /// Any reading at a pixel, metres; 0 where there is none.
  double reading(std::uint32_t pixel) const { return readings_[pixel]; }
  /// True where there is a mask and the pixel has no reading: whether a surface is there is not known.
  bool is_unknown(std::uint32_t pixel) const { return unknown_[pixel] != 0; }

 private:
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::uint8_t> unknown_;
  std::vector<float> readings_;
  KdTree tree_;
};

/// The point of a pixel's ray at a depth along the optical axis, camera frame, metres.
Eigen::Vector3d point_at(const Intrinsics& intrinsics, std::uint32_t pixel, double depth);

/// How far single precision may put a distance between points at p and within `delta` of it wrong, metres.
double distance_rounding(const Eigen::Vector3d& p, double delta);

}  // namespace perch
