#pragma once

#include <cstdint>
#include <vector>

#include "perch/candidates/first_scenes.hpp"
#include "perch/candidates/fixed_candidates.hpp"
#include "perch/localize/progress.hpp"
#include "perch/localize/settings.hpp"
#include "perch/search/search_result.hpp"

namespace perch {

/// What a search for the cheapest scene gave.
struct SearchOutcome {
  /// The best scene and other good ones that were met, cheapest first; may be empty.
  std::vector<CandidateScene> scenes;
  std::int64_t lower_bound = 0;  ///< no scene searched for costs less
  StopReason reason = StopReason::infeasible;
  std::uint64_t generated = 0, expanded = 0;
};

/// Over a fixed set: first scenes, then the Lagrangian bound, which drops the candidates that no better scene
/// can hold, then branch and bound or Focal-MHA* over those left. What was dropped costs at least as much as
/// the first scene, so the bound holds for the whole set. Branch and bound values of the open hypotheses what
/// the bound asks for, Focal-MHA* all of them, and it cuts the set's lists to what was left.
SearchOutcome search_fixed(const LocalizationProblem& problem, FixedCandidates& candidates,
                           std::vector<CandidateMaker>& makers, const std::vector<PriorPose>& priors,
                           const Settings& settings, const Executor& executor, const StopCondition& stop,
                           ProgressLog& log);

/// Focal-MHA* with ICP in the context of each parent scene; candidates made are added to the set.
/// \param hypotheses where the number of these is added.
SearchOutcome search_in_context(const LocalizationProblem& problem, FixedCandidates& candidates,
                                std::vector<CandidateMaker>& makers, const std::vector<PriorPose>& priors,
                                const Settings& settings, const Executor& executor, const StopCondition& stop,
                                ProgressLog& log, std::int64_t& hypotheses);

}  // namespace perch
