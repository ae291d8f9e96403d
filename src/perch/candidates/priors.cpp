#include "perch/candidates/priors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
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
    if (problem.kind_of(prior.model) != problem.kind_of(candidate.model)) continue;
    const ObjectModel& model = problem.models()[candidate.model];
    const double d = prior.model == candidate.model
                         ? pose_distance(model, candidate.pose, prior.pose)
                         : std::hypot(candidate.pose.x - prior.pose.x, candidate.pose.y - prior.pose.y) +
                               model.radius() * std::numbers::pi;
    nearest = std::min(nearest.value_or(d), d);
  }
  return nearest.value_or(0.0);
}

std::vector<CandidateId> nearest_to_priors(const LocalizationProblem& problem, const CandidateSet& set,
                                           const std::vector<PriorPose>& priors) {
  std::vector<int> left = problem.copies();
  std::vector<char> crowded(problem.models().size(), 0);  // no candidate fits in any more
  std::vector<CandidateId> chosen;
  for (const PriorPose& prior : priors) {
    const std::size_t kind = problem.kind_of(prior.model);
    if (left[kind] == 0 || crowded[prior.model]) continue;
    std::optional<CandidateId> nearest;
    double least = std::numeric_limits<double>::infinity();
    for (const CandidateId id : set.of_kind(kind)) {
      if (set[id].absent || set[id].model != prior.model) continue;
      const double d = pose_distance(problem.models()[prior.model], set[id].pose, prior.pose);
      if (d >= least || std::any_of(chosen.begin(), chosen.end(),
                                    [&](CandidateId other) { return problem.collide(set[id], set[other]); }))
        continue;
      least = d;
      nearest = id;
    }
    if (!nearest) {  // as none fits beside those chosen, none will for a later prior
      crowded[prior.model] = 1;
      continue;
    }
    chosen.push_back(*nearest);
    --left[kind];
  }
  return chosen;
}

}  // namespace perch
