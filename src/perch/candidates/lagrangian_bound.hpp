#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "perch/candidates/candidate_set.hpp"
#include "perch/candidates/coarse_dual.hpp"
#include "perch/candidates/lagrangian.hpp"

namespace perch {

/// What the Lagrangian bound says of scenes that hold given candidates: base + the sum of their reduced
/// costs, in fixed point. Never falls when a candidate is added.
class ReducedCosts {
 public:
  using Weight = Lagrangian::Weight;

  ReducedCosts() = default;
  ReducedCosts(Weight base, std::vector<Weight> reduced) : base_(base), reduced_(std::move(reduced)) {}

  /// Of one more candidate; >= 0.
  Weight reduced_cost(CandidateId id) const { return reduced_[id]; }
  /// Of a scene that holds nothing yet.
  Weight base() const { return base_; }

 private:
  Weight base_ = 0;
  std::vector<Weight> reduced_;
};

/// The Lagrangian bound over a fixed candidate set: at most the flat J of every collision-free scene of its
/// candidates, mutual occlusion included, since a point stays unexplained unless some E(c) holds it, and each
/// pixel of the union of the B(c) costs a rendered point.
class LagrangianBound {
 public:
  /// Keeps references; the set's candidates are those of its of_kind lists. \param start weights to begin
  /// with, or nullptr.
  LagrangianBound(const LocalizationProblem& problem, const CandidateSet& set,
                  const CoarseDual* start = nullptr);

  /// See Lagrangian::improve; `upper_bound` is J of a known scene.
  void improve(int iterations, std::int64_t upper_bound, double enough, const Executor& executor,
               const StopCondition& stop);
  /// Moves from U(c) to B(c) the pixels where no candidate left for another object can show an explained
  /// point in front.
  void widen_certain(std::vector<CandidateMaker>& makers, const Executor& executor);

  /// Where k copies of a kind are left to k places of a known scene, gives each place a slot of its own:
  /// candidates go to the nearest place, and every other way to share out the copies is shown to cost at
  /// least the upper bound. Where that can't be shown nothing changes. \param known the scene's candidates.
  void separate_copies(const std::vector<CandidateId>& known, int iterations, std::int64_t upper_bound,
                       const Executor& executor, const StopCondition& stop);

  /// No scene made of the candidates that are left costs less; scenes with a dropped one cost at least the
  /// upper bound it was dropped for.
  std::int64_t lower_bound() const { return lagrangian_.lower_bound(); }
  /// Of each candidate of the set, by number: not dropped.
  std::vector<char> kept() const;
  std::size_t kept_count() const { return lagrangian_.kept_count(); }
  /// At the best weights found; zero for dropped candidates.
  ReducedCosts reduced_costs() const;
  /// Slots: a kind's objects, or one of them where copies are separated.
  const std::vector<int>& copies() const { return lagrangian_.covering().copies; }
  std::size_t slot(CandidateId id) const { return slot_of_[id]; }
  /// The weights mu of the points of I.
  std::vector<Lagrangian::Weight> point_weights() const;

 private:
  void compact();
  void take_weights(const CoarseDual& start);

  const LocalizationProblem& problem_;
  const CandidateSet& set_;
  std::vector<CandidateId> ids_;                    ///< of the options
  std::vector<std::size_t> slot_of_;                ///< of each candidate
  std::vector<std::uint32_t> point_of_, pixel_of_;  ///< points of I and image pixels, by covering numbers
  Lagrangian lagrangian_;
};

}  // namespace perch
