#pragma once

#include <optional>

#include "perch/baselines/baseline.hpp"
#include "perch/candidates/grid.hpp"
#include "perch/core/stop.hpp"
#include "perch/localize/scene.hpp"
#include "perch/model/collision.hpp"
#include "perch/parallel/executor.hpp"
#include "perch/refine/icp.hpp"

namespace perch {

struct BfworSettings {
  GridSettings grid;
  RefineSettings refine;
  CollisionSettings collision;
  /// A model point farther from the observed cloud than this counts as if it were this far, metres. Not in
  /// the paper: there every point counts with its distance, also those that can't be seen.
  std::optional<double> distance_limit;
  int samples = 500;  ///< points of the whole model

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

/// Brute force without rendering (Narayanan and Likhachev, ICRA 2016, the baseline BFw/oR; details as in the
/// authors' own code): the full model, seen or not, is slid over the observed cloud on the grid of poses,
/// aligned by ICP at each, and valued by ICP's fitness, the mean squared distance of its points from the
/// nearest observed one. Objects are placed one after the other, each at the best fitness that is free of
/// collisions with those before, and all orders are tried. See docs/baselines.md. The same answer for every
/// executor. Throws InputError where nothing was observed or the grid is too large, InvalidSetting.
BaselineAnswer bfwor(const Scene& scene, const BfworSettings& settings, const Executor& executor,
                     const StopCondition& stop);

}  // namespace perch
