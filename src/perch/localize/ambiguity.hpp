#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "perch/candidates/fixed_candidates.hpp"
#include "perch/localize/finish_settings.hpp"
#include "perch/localize/object_trials.hpp"
#include "perch/localize/result.hpp"

namespace perch {

/// How well the observation tells one object's pose from others; see docs/confidence.md.
struct ObjectJudgement {
  std::int64_t visible = 0;           ///< its rendered points that nothing hides
  std::int64_t support = 0;           ///< how much more the scene costs without the object
  std::optional<RunnerUp> runner_up;  ///< the cheapest other pose met, all other objects as they are
  double confidence = 0.0;            ///< in [0, 1]
};

struct JudgedScene {
  ArrangedScene scene;
  std::vector<ObjectJudgement> objects;  ///< as placed in the scene; empty where nothing was judged
};

/// Looks for the runner-up of every object: among all candidates of its kind, valued or not, outside the
/// neighbourhood of its pose, and just outside that neighbourhood; the best few are moved downhill as the
/// polish moves the answer. Where one turns out better than the answer, by the rule of the polish, it takes
/// its place and all is judged anew. The same for every executor. Where the stop condition strikes, the best
/// scene so far without judgements. \param scene collision-free, with its exact J.
JudgedScene judge(const LocalizationProblem& problem, const FixedCandidates& candidates,
                  std::vector<CandidateMaker>& makers, const Executor& executor, ArrangedScene scene,
                  const AmbiguitySettings& settings, const PolishSettings& polish, const StopCondition& stop);

/// From the counts of a judgement: 0 where the object explains no more than it leaves unexplained or another
/// pose costs no more; near 1 where half of its visible points or more speak for it and every other pose
/// costs far more than counts scatter. \param increase of J at the runner-up; empty where there is none.
double confidence(std::int64_t visible, std::int64_t support, std::optional<std::int64_t> increase);

}  // namespace perch
