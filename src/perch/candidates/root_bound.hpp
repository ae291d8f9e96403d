#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "perch/candidates/coarse_dual.hpp"
#include "perch/candidates/fixed_candidates.hpp"
#include "perch/candidates/greedy_scene.hpp"
#include "perch/candidates/lagrangian_bound.hpp"
#include "perch/candidates/priors.hpp"

namespace perch {

/// Brings the Lagrangian bound of all fixed candidates as high as is asked for, and values few of them: a
/// hypothesis is rendered only where what it may explain at most, by the weights so far, could lower the
/// bound or be part of a better scene than the one known (pricing, as in column generation). Exact.
class RootBound {
 public:
  /// Keeps references.
  RootBound(const LocalizationProblem& problem, FixedCandidates& candidates, const Executor& executor);

  /// Values what is nearest to priors. False where the stop condition struck.
  bool value_near(const std::vector<PriorPose>& priors, const StopCondition& stop);
  /// A greedy scene beside what is `placed` already, among what is valued: before each choice what may
  /// explain most is. Empty where no candidate fits, or where the stop condition struck. Where nothing was
  /// placed, every kind has a valued candidate then, if any of it is in view anywhere.
  std::optional<CandidateScene> greedy_scene(const std::vector<CandidateId>& placed, CandidateMaker& maker,
                                             const StopCondition& stop);
  /// Values what may explain most of each kind beside the other kinds' objects in a scene. False where the
  /// stop condition struck.
  bool value_beside(const std::vector<CandidateId>& scene, const StopCondition& stop);

  enum class Step { valued, complete, interrupted };
  /// Improves the weights, prices the open hypotheses, and values some of those that stand in the way. Where
  /// it completes, the open hypotheses that are left are of no use: lower_bound() has reached `enough`, or no
  /// scene with one of them costs less than the upper bound. Every kind has a valued candidate. \param
  /// upper_bound cost of a known scene.
  Step step(std::int64_t upper_bound, double enough, const StopCondition& stop);

  /// No scene of the fixed candidates costs less, as far as the steps have shown.
  std::int64_t lower_bound() const { return lower_bound_; }
  /// Over the valued candidates, with the weights of the last step.
  LagrangianBound bound() const { return LagrangianBound(problem_, candidates_.set(), &dual_); }

 private:
  /// Values for each kind in which `wanted` is not 0 the hypotheses of each of its bodies most worth a
  /// rendering, as far as one can guess, among those that collide with nothing placed.
  bool value_promising(const std::vector<std::vector<std::int64_t>>& point_weights,
                       const std::vector<int>& wanted, const std::vector<CandidateId>& placed,
                       const StopCondition& stop);
  bool value_unseen_kinds(const StopCondition& stop);
  std::vector<std::size_t> price(std::int64_t upper_bound, double enough);
  /// The kind of an open hypothesis.
  std::size_t kind_of(std::size_t open) const { return problem_.kind_of(candidates_.open()[open].model); }
  /// Of each open hypothesis: at most what it is worth.
  std::vector<Lagrangian::Weight> most_worth() const;

  const LocalizationProblem& problem_;
  FixedCandidates& candidates_;
  const Executor& executor_;
  CoarseDual dual_;
  std::int64_t lower_bound_ = 0;
};

}  // namespace perch
