#pragma once

#include <cstddef>
#include <filesystem>
#include <numbers>

#include "perch/baselines/baseline.hpp"
#include "perch/baselines/trained_model.hpp"
#include "perch/core/stop.hpp"
#include "perch/localize/scene.hpp"
#include "perch/parallel/executor.hpp"
#include "perch/refine/icp.hpp"

namespace perch {

/// $XDG_CACHE_HOME/perch, else $HOME/.cache/perch, else no folder.
std::filesystem::path default_training_cache();

/// With `neighbours` 1 and `largest_tilt` pi this is the method of the paper; the defaults give it more.
struct OurCvfhSettings {
  TrainingSettings training;
  double cluster_tolerance = 0.01;  ///< points farther apart than this belong to different clusters, metres
  int least_cluster = 30;           ///< points of a cluster after thinning, at least
  /// Descriptors of a model nearest to the cluster's whose poses are refined; the best is kept.
  int neighbours = 30;
  double largest_tilt = std::numbers::pi / 6.0;  ///< poses whose z axis leans more than this don't count
  RefineSettings refine;                         ///< `reach` 0.03 m where not set
  std::filesystem::path cache = default_training_cache();  ///< for what was learned; empty: none

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

/// OUR-CVFH as a baseline (Narayanan and Likhachev, ICRA 2016): the observed points fall into clusters, the K
/// largest are described, each object is given the cluster whose descriptor is nearest to one of the model's
/// 642 views, at the least sum of distances, and the pose that the two reference frames imply is projected to
/// (x, y, yaw) and refined by ICP. Objects beyond the number of clusters get no pose. Learns the models that
/// the cache lacks, which takes minutes. See docs/baselines.md. The same answer for every executor. Throws
/// InputError where nothing was observed, InvalidSetting.
BaselineAnswer our_cvfh(const Scene& scene, const OurCvfhSettings& settings, const Executor& executor,
                        const StopCondition& stop);

/// Learns the models of a scene that the cache lacks, ahead of time. Throws as our_cvfh, and Interrupted.
void train_our_cvfh(const Scene& scene, const OurCvfhSettings& settings, const Executor& executor,
                    const StopCondition& stop);

}  // namespace perch
