#include "perch/candidates/fixed_candidates.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>

namespace perch {
namespace {

constexpr std::size_t batch = 16;  // hypotheses that a worker takes at a time

}  // namespace

FixedCandidates::FixedCandidates(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers,
                                 const Executor& executor)
    : problem_(problem), makers_(makers), executor_(executor), set_(problem) {}

bool FixedCandidates::refine(const StopCondition& stop) {
  for (std::size_t model = 0; model < problem_.models().size(); ++model) {
    const std::size_t kind = problem_.kind_of(model);
    if (problem_.copies()[kind] == 0) continue;
    const PoseGrid& grid = problem_.grid(model);
    const auto poses = static_cast<std::size_t>(grid.size());
    std::vector<std::optional<Hypothesis>> refined(poses);
    if (!for_each_batched(executor_, poses, batch, stop, [&](std::size_t i, std::size_t worker) {
          CandidateMaker& maker = makers_[worker];
          const auto [pose, misfit] = maker.refined(model, grid.pose(static_cast<std::int64_t>(i)));
          const Window window = problem_.window(model, pose);
          if (!window.empty() && problem_.admits(model, pose))
            refined[i] = Hypothesis{model, pose, static_cast<float>(misfit), window,
                                    problem_.explained_bound().blocks(
                                        problem_.models()[model], problem_.camera_from_model(model, pose))};
        }))
      return false;
    hypotheses_ += static_cast<std::int64_t>(poses);
    std::set<std::tuple<double, double, double>> met;
    for (auto& hypothesis : refined)
      if (hypothesis && met.emplace(hypothesis->pose.x, hypothesis->pose.y, hypothesis->pose.yaw).second)
        open_.push_back(std::move(*hypothesis));
    if (problem_.optional(kind) && model == problem_.bodies_of(kind).front())
      set_.add(absent_candidate(model));
  }
  count_ = static_cast<std::int64_t>(open_.size() + set_.size());
  return true;
}

bool FixedCandidates::value(const std::vector<std::size_t>& which, const StopCondition& stop) {
  std::vector<std::optional<Candidate>> made(which.size());
  if (!executor_.for_each(
          which.size(),
          [&](std::size_t i, std::size_t worker) {
            const Hypothesis& hypothesis = open_[which[i]];
            made[i] = makers_[worker].value(hypothesis.model, hypothesis.pose);
          },
          stop))
    return false;
  for (auto& candidate : made)
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
