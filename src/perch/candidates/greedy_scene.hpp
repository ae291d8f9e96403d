#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "perch/candidates/candidate_set.hpp"
#include "perch/observation/point_set.hpp"

namespace perch {

/// K candidates, one for each object (ascending numbers), and their flat J.
struct CandidateScene {
  std::vector<CandidateId> candidates;
  std::int64_t cost = 0;
};

/// J of a set of candidates.
std::int64_t scene_cost(const LocalizationProblem& problem, const CandidateSet& set,
                        const std::vector<CandidateId>& candidates, CandidateMaker& maker);

/// A scene that is being put together.
struct UnfinishedScene {
  std::vector<CandidateId> placed;
  std::vector<int> left;  ///< copies of each kind that are not placed yet
  PointSet covered;       ///< points of I that some placed candidate alone explains

  UnfinishedScene(const LocalizationProblem& problem, const CandidateSet& set,
                  const std::vector<CandidateId>& placed);
  void place(const CandidateSet& set, CandidateId id);
};

/// Places one object after the other, always the candidate that explains most more than it leaves to be
/// explained beside those placed, without collisions. \param before_choice may add candidates to the set, and
/// take kinds out of the choice by setting their copies left to 0 in its second argument; false gives up.
/// Empty then, and where no candidate fits.
std::optional<CandidateScene> greedy_scene(
    const LocalizationProblem& problem, const CandidateSet& set, UnfinishedScene scene, CandidateMaker& maker,
    const std::function<bool(const UnfinishedScene& scene, std::vector<int>& choice)>& before_choice);

}  // namespace perch
