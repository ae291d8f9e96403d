#pragma once

#include <vector>

#include "perch/localize/finish_settings.hpp"
#include "perch/localize/object_trials.hpp"

namespace perch {

/// Moves the objects of a scene, one at a time, as long as that pays (PoseDescent). Objects stay in their
/// workspaces and clear of each other, yaws canonical. The same for every executor; less when the stop
/// condition strikes or the trials are spent. J of the answer is below that of `start`, or the answer is
/// `start`. \param makers one for each worker. \param start collision-free, with its exact J. \param worker
/// the one that calls, where that is one of them.
ArrangedScene polish(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers,
                     const Executor& executor, const ArrangedScene& start, const PolishSettings& settings,
                     const StopCondition& stop, std::size_t worker = 0);

/// The cheapest of the first few starts after polishing each; among equals the first. Starts that cost half
/// as much again as the first are left out, and those that resemble one before. \param starts at
/// least one, cheapest first.
ArrangedScene polish_best(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers,
                          const Executor& executor, const std::vector<ArrangedScene>& starts,
                          const PolishSettings& settings, const StopCondition& stop);

}  // namespace perch
