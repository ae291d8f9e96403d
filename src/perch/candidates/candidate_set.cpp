#include "perch/candidates/candidate_set.hpp"

namespace perch {

CandidateId CandidateSet::add(Candidate candidate) {
  const auto [place, is_new] = numbers_.try_emplace(
      {candidate.model, candidate.absent, candidate.pose.x, candidate.pose.y, candidate.pose.yaw},
      static_cast<CandidateId>(size()));
  if (is_new) {
    of_model_[candidate.model].push_back(place->second);
    candidates_.push_back(std::move(candidate));
  }
  return place->second;
}

void CandidateSet::restrict_to(const std::vector<char>& keep) {
  for (auto& ids : of_model_) std::erase_if(ids, [&](CandidateId id) { return keep[id] == 0; });
}

std::size_t CandidateSet::bytes() const {
  std::size_t sum = 0;
  for (const Candidate& c : candidates_)
    sum += sizeof(Candidate) + c.explained.bytes() + c.enclosed.bytes() + c.reached.bytes() +
           c.patch.depth.size() * sizeof(float) +
           (c.explained_runs.size() + c.certain_runs.size() + c.uncertain_runs.size() +
            c.explained_pixels.size()) *
               sizeof(Run);
  return sum;
}

std::vector<CandidateMaker> make_makers(const LocalizationProblem& problem, const Executor& executor) {
  std::vector<CandidateMaker> makers;
  makers.reserve(executor.workers());
  for (std::size_t i = 0; i < executor.workers(); ++i) makers.emplace_back(problem);
  return makers;
}

FixedCandidates make_fixed_candidates(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers,
                                      const Executor& executor, const StopCondition& stop) {
  FixedCandidates fixed{CandidateSet(problem.models().size())};
  for (std::size_t model = 0; model < problem.models().size() && fixed.complete; ++model) {
    if (problem.copies()[model] == 0) continue;
    const auto poses = static_cast<std::size_t>(problem.grid(model).size());
    std::vector<std::optional<Candidate>> made(poses);
    fixed.complete = executor.for_each(
        poses,
        [&](std::size_t i, std::size_t worker) {
          made[i] = makers[worker].make(model, problem.grid(model).pose(static_cast<std::int64_t>(i)));
        },
        stop);
    if (!fixed.complete) break;
    fixed.hypotheses += static_cast<std::int64_t>(poses);
    for (auto& candidate : made)
      if (candidate) fixed.set.add(std::move(*candidate));
    if (problem.optional(model)) fixed.set.add(absent_candidate(model));
  }
  return fixed;
}

}  // namespace perch
