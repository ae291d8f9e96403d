#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "perch/core/camera.hpp"
#include "perch/core/image.hpp"

namespace perch {

/// What the depth image says of a pixel.
enum class PixelState : std::uint8_t {
  unknown,  ///< no reading: a surface may or may not be there
  free,     ///< a reading that belongs to no object of interest, so none stands in front of it
  object    ///< a reading that belongs to an object of interest: a point of I
};

/// The observed points I, one per valid pixel that belongs to objects of interest, and what is known of the
/// other pixels.
class Observation {
 public:
  /// \param depth metres, 0 = no reading; the size of the intrinsics.
  /// \param mask non-zero: the pixel belongs to an object of interest. Without one every reading does, and a
  /// pixel without
  ///   a reading counts as free, since the background was removed from the depth image itself.
  /// Throws InputError where I is empty or has fewer points than can support a pose.
  Observation(const Camera& camera, const DepthImage& depth, const std::optional<Image<std::uint8_t>>& mask);

  const Camera& camera() const { return camera_; }
  const Intrinsics& intrinsics() const { return camera_.intrinsics; }
  const RaySlopes& rays() const { return rays_; }

  PixelState state(int u, int v) const { return states_(u, v); }
  /// Depth of the point of I at a pixel, metres; 0 where there is none.
  float depth(int u, int v) const { return depth_(u, v); }

  /// Depth of any reading at a pixel, of an object of interest or not, metres; 0 where there is none.
  float reading(int u, int v) const { return readings_(u, v); }

  /// The points of I in row-major order of their pixels, camera frame.
  const std::vector<Eigen::Vector3f>& points() const { return points_; }
  std::size_t size() const { return points_.size(); }
  /// Column of the pixel of point i.
  int column(std::size_t i) const { return columns_[i]; }
  /// The points of row v are row_begin(v) .. row_begin(v + 1) - 1, by ascending column.
  std::size_t row_begin(int v) const { return row_begin_[static_cast<std::size_t>(v)]; }
  /// The smallest window that holds all of I.
  const Window& window() const { return window_; }
  float nearest() const { return nearest_; }
  float farthest() const { return farthest_; }

 private:
  Camera camera_;
  RaySlopes rays_;
  Image<PixelState> states_;
  DepthImage depth_, readings_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<int> columns_;
  std::vector<std::size_t> row_begin_;
  Window window_;
  float nearest_ = 0.0F, farthest_ = 0.0F;
};

}  // namespace perch
