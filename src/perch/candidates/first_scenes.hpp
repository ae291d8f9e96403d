#pragma once

#include <cstdint>
#include <vector>

#include "perch/candidates/greedy_scene.hpp"
#include "perch/candidates/priors.hpp"

namespace perch {

/// Good scenes to start from: built greedily, object by object, from several first choices, then improved by
/// exchanging one candidate at a time for another of its kind while J falls. No two candidates of a scene
/// collide. One more start holds the candidates nearest to the priors. Cheapest first, each once; empty where
/// no collision-free scene was met. The same for every executor; less when the stop condition strikes.
std::vector<CandidateScene> first_scenes(const LocalizationProblem& problem, const CandidateSet& set,
                                         std::vector<CandidateMaker>& makers, const Executor& executor,
                                         const StopCondition& stop,
                                         const std::vector<PriorPose>& priors = {});

/// Exchanges one candidate of the scene at a time for the best other one of its kind, as long as J falls.
/// True where it fell. \param from candidates below this number have been tried in this very scene.
bool improve_scene(const LocalizationProblem& problem, const CandidateSet& set,
                   std::vector<CandidateMaker>& makers, const Executor& executor, const StopCondition& stop,
                   CandidateScene& scene, CandidateId from = 0);

}  // namespace perch
