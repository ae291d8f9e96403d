#include "perch/candidates/priors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace perch {

double pose_distance(const ObjectModel& model, const Pose& a, const Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y) + model.radius() * model.symmetry().yaw_difference(a.yaw, b.yaw);
}

double prior_distance(const LocalizationProblem& problem, const Candidate& candidate,
                      const std::vector<PriorPose>& priors) {
  if (candidate.absent) return 0.0;
  std::optional<double> nearest;
  for (const PriorPose& prior : priors) {
    if (prior.model != candidate.model) continue;
    const double d = pose_distance(problem.models()[candidate.model], candidate.pose, prior.pose);
    nearest = std::min(nearest.value_or(d), d);
  }
  return nearest.value_or(0.0);
}

std::vector<CandidateId> nearest_to_priors(const LocalizationProblem& problem, const CandidateSet& set,
                                           const std::vector<PriorPose>& priors) {
  std::vector<int> left = problem.copies();
  std::vector<CandidateId> chosen;
  for (const PriorPose& prior : priors) {
    if (left[prior.model] == 0) continue;
    std::optional<CandidateId> nearest;
    double least = std::numeric_limits<double>::infinity();
    for (const CandidateId id : set.of_model(prior.model)) {
      if (set[id].absent) continue;
      const double d = pose_distance(problem.models()[prior.model], set[id].pose, prior.pose);
      if (d >= least || std::any_of(chosen.begin(), chosen.end(),
                                    [&](CandidateId other) { return problem.collide(set[id], set[other]); }))
        continue;
      least = d;
      nearest = id;
    }
    if (!nearest) {  // as none fits beside those chosen, none will for a later prior
      left[prior.model] = 0;
      continue;
    }
    chosen.push_back(*nearest);
    --left[prior.model];
  }
  return chosen;
}

}  // namespace perch
