#pragma once

#include <vector>

#include "perch/candidates/candidate_set.hpp"

namespace perch {

/// A pose that some other detector proposes; `model` counts into the problem's models. It may be wrong.
struct PriorPose {
  std::size_t model = 0;
  Pose pose;
};

/// How far two poses of a model are apart: metres in the plane plus the arc that the yaws differ by at the
/// model's radius, modulo its symmetry.
double pose_distance(const ObjectModel& model, const Pose& a, const Pose& b);

/// How far a candidate is from the nearest prior of its kind. One of another body, as it rests in another
/// way, is half a turn off. 0 where the kind has no prior or the object is absent.
double prior_distance(const LocalizationProblem& problem, const Candidate& candidate,
                      const std::vector<PriorPose>& priors);

/// The candidates nearest to the priors, one for each as far as there are copies, without collisions; of the
/// same body. In the order of the priors.
std::vector<CandidateId> nearest_to_priors(const LocalizationProblem& problem, const CandidateSet& set,
                                           const std::vector<PriorPose>& priors);

}  // namespace perch
