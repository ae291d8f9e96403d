#pragma once

#include <optional>

#include "perch/core/pose.hpp"
#include "perch/observation/nearest_table.hpp"
#include "perch/refine/surface_samples.hpp"

namespace perch {

enum class RefineMethod { none, icp };

struct RefineSettings {
  static constexpr double largest_reach = 0.2;  ///< metres

  RefineMethod method = RefineMethod::icp;
  std::optional<double> reach;  ///< farthest correspondence, metres; half the grid step where not set
  int rounds = 2;               ///< times that the object is looked at anew and aligned
  int iterations = 30;          ///< of one round, at most
  int samples = 250;            ///< points of the object's surface used in a round, about
  double least_matched = 0.1;   ///< share of the samples that must find a point of I, or nothing is moved
  double robust_scale = 0.003;  ///< residual at which a point's weight is halved, metres
  double occlusion = 0.02;      ///< a point this far behind the observed one is taken as hidden, metres

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

struct Alignment {
  Pose pose;
  /// 1 - the samples' mean weight before the last step, where those without a point of I near weigh nothing.
  double misfit = 1.0;

  friend bool operator==(const Alignment&, const Alignment&) = default;
};

/// ICP in (x, y, yaw): moves the samples (world frame) of an object at `pose` onto I by point-to-plane
/// distances along the samples' normals with the robust weight 1 / (1 + |e| / robust_scale) (Chen and Medioni
/// 1992; weight of the "fair" M-estimator). \param fix_yaw for solids of revolution. \return the pose after
/// the last step; the pose given where fewer than `least_matched` of the samples lie within reach of I at the
/// start.
Alignment align(const SurfaceSamples& samples, const Pose& pose, bool fix_yaw, const NearestTable& observed,
                double reach, const RefineSettings& settings);

/// The samples' mean distance from I along their normals, in units of `limit` (metres) and at most 1 each; 1
/// for a sample that the table knows no observed point near to, and for no samples.
double mean_residual(const SurfaceSamples& samples, const NearestTable& observed, double limit);

}  // namespace perch
