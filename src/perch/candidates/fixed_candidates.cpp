#include "perch/candidates/fixed_candidates.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <tuple>

#include "perch/candidates/candidate_batches.hpp"

namespace perch {
FixedCandidates::FixedCandidates(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers,
                                 const Executor& executor)
    : problem_(problem), makers_(makers), executor_(executor), set_(problem) {}

bool FixedCandidates::refine(const StopCondition& stop) {
  RefineBatch batch(problem_, makers_);
  const bool complete = executor_.spread(batch, stop);
  makers_.front().credit(batch.effort_elsewhere);
  if (!complete) return false;
  hypotheses_ = static_cast<std::int64_t>(batch.size());
  std::set<std::tuple<std::size_t, double, double, double>> met;
  for (auto& hypothesis : batch.refined)
    if (hypothesis &&
        met.emplace(hypothesis->model, hypothesis->pose.x, hypothesis->pose.y, hypothesis->pose.yaw).second)
      open_.push_back(std::move(*hypothesis));
  for (std::size_t kind = 0; kind < problem_.kinds(); ++kind)
    if (problem_.copies()[kind] > 0 && problem_.optional(kind))
      set_.add(absent_candidate(problem_.bodies_of(kind).front()));
  count_ = static_cast<std::int64_t>(open_.size() + set_.size());
  return true;
}

bool FixedCandidates::value(const std::vector<std::size_t>& which, const StopCondition& stop) {
  ValueBatch batch(open_, which, makers_);
  const bool complete = executor_.spread(batch, stop);
  makers_.front().credit(batch.effort_elsewhere);
  if (!complete) return false;
  for (auto& candidate : batch.made)
    if (candidate) set_.add(std::move(*candidate));
  std::size_t next = 0, left = 0;
  for (std::size_t i = 0; i < open_.size(); ++i) {
    if (next < which.size() && which[next] == i)
      ++next;
    else
      std::swap(open_[left++], open_[i]);
  }
  open_.resize(left);
  return true;
}

bool FixedCandidates::value_all(const StopCondition& stop) {
  std::vector<std::size_t> all(open_.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return value(all, stop);
}

std::vector<FixedCandidates::Weight> FixedCandidates::sums_of(
    const std::vector<Weight>& point_weights) const {
  const std::vector<Weight> weights = problem_.blocks().sums(point_weights);
  std::vector<Weight> sums(weights.size() + 1, 0);
  std::partial_sum(weights.begin(), weights.end(), sums.begin() + 1);
  return sums;
}

std::vector<FixedCandidates::Weight> FixedCandidates::most_explained(
    const std::vector<std::vector<Weight>>& point_weights, const std::vector<int>& wanted) const {
  std::vector<std::vector<Weight>> sums;
  for (const auto& of_kind : point_weights) sums.push_back(sums_of(of_kind));
  std::vector<Weight> most(open_.size(), 0);
  for (std::size_t i = 0; i < open_.size(); ++i) {
    const std::size_t kind = problem_.kind_of(open_[i].model);
    if (wanted[kind] == 0) continue;
    const std::vector<Weight>& own = sums[sums.size() == 1 ? 0 : kind];
    for (const Run& run : open_[i].near) most[i] += own[run.last] - own[run.first];
  }
  return most;
}

}  // namespace perch
