#pragma once

#include <optional>

#include "perch/candidates/first_scenes.hpp"
#include "perch/tree/monotone.hpp"

namespace perch {

struct Enumeration {
  std::optional<CandidateScene> best;  ///< the first of the cheapest
  std::int64_t scenes = 0;             ///< valued: free of collisions and, where asked for, monotone
  bool complete = true;                ///< false where the stop condition struck
};

/// Values every scene of a fixed set: each way to choose one candidate for each object that is free of
/// collisions, copies of a kind in no order. \param monotone only scenes that some order builds
/// monotonically; nullptr: all. Throws InputError where there are more than 10 million ways to choose.
Enumeration enumerate_scenes(const LocalizationProblem& problem, const CandidateSet& set,
                             std::vector<CandidateMaker>& makers, const Executor& executor,
                             const MonotoneSettings* monotone, const StopCondition& stop);

}  // namespace perch
