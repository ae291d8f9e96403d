#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "perch/candidates/priors.hpp"
#include "perch/candidates/problem.hpp"
#include "perch/tree/scene_tree.hpp"

namespace perch {

/// h of the anchor queue: what the tree's bound promises beyond g. Admissible and consistent, since the bound
/// never falls along an edge.
double bound_heuristic(const SceneState& state);

/// `depth` = K - |s|: prefers scenes with more objects placed (paper, section IV-D).
class DepthHeuristic {
 public:
  explicit DepthHeuristic(std::size_t object_count) : object_count_(object_count) {}
  double operator()(const SceneState& state) const;

 private:
  std::size_t object_count_;
};

/// `overlap` = |I| minus the points of I inside the union of the placed solids dilated by delta (paper,
/// section IV-D).
class OverlapHeuristic {
 public:
  /// Keeps references.
  OverlapHeuristic(const LocalizationProblem& problem, const CandidateSet& set)
      : problem_(problem), set_(set) {}
  double operator()(const SceneState& state) const;

 private:
  const LocalizationProblem& problem_;
  const CandidateSet& set_;
};

/// `prior`: sum over the placed objects of the distance to the nearest pose that some other detector proposed
/// for their model, metres. Remembers the distances: one for each thread.
class PriorHeuristic {
 public:
  /// Keeps references to problem and set.
  PriorHeuristic(const LocalizationProblem& problem, const CandidateSet& set, std::vector<PriorPose> priors)
      : problem_(problem), set_(set), priors_(std::move(priors)) {}
  double operator()(const SceneState& state) const;

 private:
  const LocalizationProblem& problem_;
  const CandidateSet& set_;
  std::vector<PriorPose> priors_;
  mutable std::vector<std::optional<double>> distances_;  ///< by candidate, once asked for
};

}  // namespace perch
