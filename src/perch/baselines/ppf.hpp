#pragma once

#include <numbers>

#include "perch/baselines/baseline.hpp"
#include "perch/core/stop.hpp"
#include "perch/cost/cost_settings.hpp"
#include "perch/localize/scene.hpp"
#include "perch/model/collision.hpp"
#include "perch/parallel/executor.hpp"
#include "perch/refine/icp.hpp"

namespace perch {

struct PpfSettings {
  double sampling_step = 0.05;  ///< of model and scene, and of pair distances; in diameters of the model
  int reference_step = 2;  ///< every so many of the thinned scene's points votes; pairs are made with all
  int angles = 30;         ///< bins of a full turn, of normals and of the rotation about them
  double normal_radius = 0.01;  ///< of the patch that an observed normal is fitted to, metres
  double greatest_tilt = 30.0 * std::numbers::pi / 180.0;  ///< of a proposed pose against upright, radians
  double greatest_lift = 0.05;  ///< of a proposed pose's model above or below its height, metres
  int proposals = 200;          ///< poses of a model that are refined, at most: those with the most votes
  RefineSettings refine;        ///< reach: 2 cm unless set
  CostSettings cost;            ///< what the joint selection counts
  CollisionSettings collision;

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

/// Point pair features (Drost, Ulrich, Navab and Ilic, "Model Globally, Match Locally", CVPR 2010) by
/// OpenCV's surface_matching. Every thinned point of the scene votes once for each model; the poses that are
/// about upright and at the model's height are projected to (x, y, yaw). Added in its favour: that
/// constraint, ICP of what is visible, and the joint selection of poses by J. See docs/baselines.md. The same
/// answer for every executor. Throws InputError where nothing was observed, InvalidSetting.
BaselineAnswer ppf(const Scene& scene, const PpfSettings& settings, const Executor& executor,
                   const StopCondition& stop);

}  // namespace perch
