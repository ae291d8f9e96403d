#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "perch/observation/observation.hpp"
#include "perch/observation/pixel_rows.hpp"
#include "perch/parallel/executor.hpp"

namespace perch {

/// The delta test, the one expression that every count goes through: in float, a point exactly at distance
/// delta counts.
inline bool within_delta(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float delta_squared) {
  const float dx = a.x() - b.x(), dy = a.y() - b.y(), dz = a.z() - b.z();
  return dx * dx + dy * dy + dz * dz <= delta_squared;
}

/// The pixels whose rays meet the ball of radius delta around a point (and, by a hair, more): all points
/// within delta of it are seen at these. Cut to the image.
Window ball_window(const Intrinsics& intrinsics, const Eigen::Vector3f& p, double delta);

/// Answers "is this rendered point within delta of a point of I?" without a search through I. For each pixel
/// it holds the least and the greatest depth, on the pixel's ray, that lie within delta of a point of I; both
/// a hair too far out, and what lies between is confirmed by the delta test itself, so that answers equal
/// brute force to the bit.
class DeltaIndex {
 public:
  /// \param delta metres, > 0. Throws Interrupted.
  DeltaIndex(const Observation& observation, double delta, const Executor& executor,
             const StopCondition& stop = StopCondition());

  double delta() const { return delta_; }
  float delta_squared() const { return delta_squared_; }

  /// True when the point of pixel (u, v) at depth z (> 0, finite) is within delta of a point of I.
  bool explained(int u, int v, float z) const;
  /// True only if no point of the pixel's ray at a depth in [z - reach, z] is within delta of a point of I.
  bool unexplained_throughout(int u, int v, float z, float reach) const {
    const std::size_t pixel = rows_.row(v) + static_cast<std::size_t>(u);
    return z < rows_.nearest[pixel] || z - reach > rows_.farthest[pixel];
  }
  const Observation& observation() const { return observation_; }
  const PixelRows& rows() const { return rows_; }
  /// ball_window of the i-th point of I.
  const Window& window(std::size_t i) const { return windows_[i]; }
  /// No point's window reaches more rows or columns than this from its own pixel.
  int reach() const { return reach_; }

 private:
  bool near_observed(int u, int v, float z) const;

  const Observation& observation_;
  double delta_;
  float delta_squared_;
  std::vector<Window> windows_;
  int reach_;
  PixelRows rows_;
};

}  // namespace perch
