#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "perch/core/image.hpp"
#include "perch/model/object_model.hpp"
#include "perch/observation/point_blocks.hpp"
#include "perch/observation/run.hpp"

namespace perch {

/// What an object can explain of I at most, without a rendering: what it explains lies within delta of its
/// surface, which the model's distance field tells up to a known error.
class ExplainedBound {
 public:
  /// Balls that cost few questions and don't blur what is near, metres; no larger than keeps distance fields
  /// small.
  static double block_radius(double delta) { return std::min(delta, 0.01); }
  /// How far around a model its distance field must reach, metres: what lies beyond is too far then.
  static double field_margin(double delta) { return delta + block_radius(delta); }

  /// \param blocks of I. \param delta metres. \param reach how many pixels a point within delta of a surface
  /// can be seen from that surface's image. Keeps a reference to the blocks.
  ExplainedBound(const Intrinsics& intrinsics, const PointBlocks& blocks, double delta, int reach)
      : intrinsics_(intrinsics), blocks_(blocks), delta_(static_cast<float>(delta)), reach_(reach) {}

  /// The pixels that an object can cover; empty where it is out of view.
  Window window(const ObjectModel& model, const Eigen::Isometry3d& camera_from_model) const;
  /// The blocks that hold every point that the object explains.
  std::vector<Run> blocks(const ObjectModel& model, const Eigen::Isometry3d& camera_from_model) const;

 private:
  const Intrinsics intrinsics_;
  const PointBlocks& blocks_;
  float delta_;
  int reach_;
};

}  // namespace perch
