#include "perch/candidates/candidate_set.hpp"

namespace perch {

CandidateSet::CandidateSet(const LocalizationProblem& problem) : of_kind_(problem.kinds()) {
  for (std::size_t model = 0; model < problem.models().size(); ++model)
    kind_of_.push_back(problem.kind_of(model));
}

CandidateId CandidateSet::add(Candidate candidate) {
  const auto [place, is_new] = numbers_.try_emplace(
      {candidate.model, candidate.absent, candidate.pose.x, candidate.pose.y, candidate.pose.yaw},
      static_cast<CandidateId>(size()));
  if (is_new) {
    of_kind_[kind_of_[candidate.model]].push_back(place->second);
    candidates_.push_back(std::move(candidate));
  }
  return place->second;
}

void CandidateSet::restrict_to(const std::vector<char>& keep) {
  for (auto& ids : of_kind_) std::erase_if(ids, [&](CandidateId id) { return keep[id] == 0; });
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

}  // namespace perch
