#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "perch/core/pose.hpp"
#include "perch/observation/nearest_table.hpp"
#include "perch/observation/observation.hpp"
#include "perch/render/depth_crosses.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {

enum class RefineMethod { none, icp };

struct RefineSettings {
  static constexpr double largest_reach = 0.2;  ///< metres

  RefineMethod method = RefineMethod::icp;
  std::optional<double> reach;  ///< farthest correspondence, metres; half the grid step where not set
  int rounds = 2;               ///< times that the object is rendered again and aligned
  int iterations = 10;          ///< of one round, at most
  int samples = 400;            ///< rendered points used in a round, about
  double least_matched = 0.1;   ///< share of the samples that must find a point of I, or nothing is moved
  double robust_scale = 0.003;  ///< residual at which a point's weight is halved, metres
  double occlusion = 0.02;  ///< a rendered point this far behind the observed one is taken as hidden, metres

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

/// A rendered point with its surface normal, world frame.
struct SurfaceSample {
  Eigen::Vector3f point;
  Eigen::Vector3f normal;
};

/// Evenly spread points of the patch that the observation does not show to be hidden, with normals from their
/// neighbours in the patch. Written into `samples`, whose memory is reused. \param in_front rendered surfaces
/// that hide the patch (the parent scene), or nullptr.
void sample_patch(const DepthPatch& patch, const DepthPatch* in_front, const Observation& observation,
                  const RefineSettings& settings, std::vector<SurfaceSample>& samples);

/// The same from a rendering of the sampled pixels only.
void sample_crosses(const DepthCrosses& crosses, const DepthPatch* in_front, const Observation& observation,
                    const RefineSettings& settings, std::vector<SurfaceSample>& samples);

/// ICP in (x, y, yaw): moves the samples of an object at `pose` onto I by point-to-plane distances along the
/// samples' normals with the robust weight 1 / (1 + |e| / robust_scale) (Chen and Medioni 1992; weight of the
/// "fair" M-estimator). \param fix_yaw for solids of revolution. \return the pose after the last step;
/// `pose` itself where fewer than `least_matched` of the samples lie within reach of I at the start.
Pose align(const std::vector<SurfaceSample>& samples, const Pose& pose, bool fix_yaw,
           const NearestTable& observed, double reach, const RefineSettings& settings);

/// The samples' mean distance from I along their normals, in units of `limit` (metres) and at most 1 each; 1
/// for a sample that the table knows no observed point near to, and for no samples.
double mean_residual(const std::vector<SurfaceSample>& samples, const NearestTable& observed, double limit);

}  // namespace perch
