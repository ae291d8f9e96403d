#pragma once

#include <cstdint>
#include <vector>

#include "perch/candidates/candidate_set.hpp"

namespace perch {

/// What the Lagrangian bound says of scenes that hold given candidates: base + the sum of their reduced
/// costs, in fixed point. Never falls when a candidate is added.
class ReducedCosts {
 public:
  using Weight = std::int64_t;  ///< in units of 1 / one
  static constexpr Weight one = Weight{1} << 20;

  ReducedCosts() = default;
  explicit ReducedCosts(std::size_t candidates) : reduced_(candidates, 0) {}

  /// Of one more candidate; >= 0.
  Weight reduced_cost(CandidateId id) const { return reduced_[id]; }
  /// Of a scene that holds nothing yet.
  Weight base() const { return base_; }
  /// A sum of these as a count: whole, so rounded up.
  static std::int64_t count(Weight sum) { return sum <= 0 ? 0 : (sum + one - 1) / one; }

 private:
  friend class LagrangianBound;
  Weight base_ = 0;
  std::vector<Weight> reduced_;
};

/// The Lagrangian bound over a fixed candidate set. For any weights mu_p in [0, 1] of the points of I and
/// nu_(m,x) >= 0 of the pixels with sum_m k_m nu_(m,x) <= 1,
///     LB = |I| - sum_p (1 - mu_p) - sum_m k_m max_{c of m} v(c),   v(c) = sum_{E(c)} mu_p - sum_{B(c)}
///     nu_(m,x)
/// is at most the flat J of every scene that takes k_m candidates of each model m, mutual occlusion included:
/// a point stays unexplained unless some E(c) holds it, and each pixel of the union of the B(c) costs a
/// rendered point. The weights are improved by a subgradient method, in fixed point, so that the bound is
/// exact. A scene that holds c costs at least LB + max v - v(c): candidates for which that reaches the cost
/// of a known scene can be dropped (reduced-cost fixing).
class LagrangianBound {
 public:
  /// Keeps a reference to the problem; the set's candidates are those of its of_model lists.
  LagrangianBound(const LocalizationProblem& problem, const CandidateSet& set);

  /// Improves the weights. Stops after `iterations`, when the bound reaches `enough`, when nothing is left to
  /// drop that could raise it, or when the stop condition strikes. \param upper_bound J of a known scene:
  /// candidates that can only be part of scenes that cost as much are dropped.
  void improve(int iterations, std::int64_t upper_bound, double enough, const Executor& executor,
               const StopCondition& stop);
  /// Adds to each B(c) the pixels where c is unexplained and no candidate left for another object stands in
  /// front.
  void widen_certain(std::vector<CandidateMaker>& makers, const Executor& executor);

  /// Where k copies of a model are left to k places of a known scene, gives each place a weight of its own:
  /// candidates go to the nearest place, and every other way to share out the copies is shown to cost at
  /// least the upper bound. Where that can't be shown nothing changes. \param known the scene's candidates.
  void separate_copies(const std::vector<CandidateId>& known, int iterations, std::int64_t upper_bound,
                       const Executor& executor, const StopCondition& stop);

  /// No scene made of the candidates that are left costs less; scenes with a dropped one cost at least the
  /// upper bound it was dropped for.
  std::int64_t lower_bound() const { return lower_bound_; }
  /// Of each candidate of the set, by number: not dropped.
  const std::vector<char>& kept() const { return kept_; }
  /// At the best weights found; zero for dropped candidates.
  const ReducedCosts& reduced_costs() const { return reduced_costs_; }
  std::size_t kept_count() const;

 private:
  using Weight = ReducedCosts::Weight;
  static constexpr Weight one = ReducedCosts::one;

  /// Candidates of which every scene takes `copies`: a model's, until its copies are separated.
  struct Slot {
    int copies = 0;
    std::vector<Weight> nu, sums;  ///< of the pixels, and summed up
  };

  std::size_t pixel(std::uint32_t image_pixel) const { return image_pixel - first_pixel_; }
  std::vector<CandidateId> left() const;
  void sum_up();
  Weight value(CandidateId id) const;
  bool step(const std::vector<CandidateId>& best, double rise);
  void share_pixels();
  std::vector<Slot>::size_type add_slot(int copies);

  const LocalizationProblem& problem_;
  const CandidateSet& set_;
  std::vector<std::vector<Run>> certain_;  ///< B(c) as runs of pixels
  std::vector<char> kept_;
  std::vector<std::size_t> slot_of_;  ///< of each candidate
  std::int64_t lower_bound_ = 0;
  ReducedCosts reduced_costs_;

  std::size_t first_pixel_ = 0, pixels_ = 0;  ///< the part of the image that any B(c) may touch
  std::vector<Weight> mu_, mu_sums_;
  std::vector<Slot> slots_;
};

}  // namespace perch
