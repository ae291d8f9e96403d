#pragma once

#include <cstdint>
#include <vector>

#include "perch/candidates/covering.hpp"
#include "perch/parallel/executor.hpp"

namespace perch {

/// A Lagrangian bound of a covering problem. For any weights mu_p in [0, 1] of the points and beta_(m,x),
/// upsilon_(m,x) >= 0 of the pixels with sum_m k_m (beta_(m,x) + upsilon_(m,x)) <= 1,
///     LB = fixed + |I| - sum_p (1 - mu_p) - sum_m k_m max_{c of m} v(c),
///     v(c) = sum_{E(c)} mu_p - sum_{B(c)} beta_(m,x) - sum_{U(c)} upsilon_(m,x) + sum_{H(c)} rho_(m,x),
///     rho_(m,x) = sum_n k_n upsilon_(n,x) - upsilon_(m,x),
/// is at most the cost of every choice that takes k_m options of each slot m: E explained, B certain, U
/// uncertain, H relieved (docs/algorithm.md has the proof). The weights are improved by a subgradient method,
/// in fixed point, so that the bound is exact. A choice that holds c costs at least LB + max v - v(c):
/// options for which that reaches the cost of a known one are dropped (reduced-cost fixing). Weights of
/// options add up: a choice costs at least base() + the sum of its reduced costs.
class Lagrangian {
 public:
  using Weight = std::int64_t;  ///< in units of 1 / one
  static constexpr Weight one = Weight{1} << 20;
  /// A sum of weights as a count: whole, so rounded up.
  static std::int64_t count(Weight sum) { return sum <= 0 ? 0 : (sum + one - 1) / one; }

  explicit Lagrangian(Covering covering);

  /// Improves the weights. Stops after `iterations`, when the bound reaches `enough`, when the steps have
  /// become small, or when the stop condition strikes. \param upper_bound cost of a known choice: options
  /// that can only be part of choices that cost as much are dropped.
  void improve(int iterations, std::int64_t upper_bound, double enough, const Executor& executor,
               const StopCondition& stop);

  /// No choice of the options that are left costs less; choices with a dropped one cost at least the upper
  /// bound it was dropped for.
  std::int64_t lower_bound() const { return lower_bound_; }
  bool kept(std::size_t option) const { return kept_[option] != 0; }
  std::size_t kept_count() const;
  /// The best bound found, not rounded, and what each option adds to it; zero for dropped options.
  Weight base() const { return base_; }
  Weight reduced_cost(std::size_t option) const { return reduced_[option]; }
  /// Of each slot the option with the largest value at the last weights.
  const std::vector<std::size_t>& best() const { return best_; }

  const Covering& covering() const { return covering_; }
  void drop(std::size_t option) { kept_[option] = 0; }
  /// Replaces B(c) and U(c). Call share_pixels() before the next improve().
  void set_unexplained(std::size_t option, std::vector<Run> certain, std::vector<Run> uncertain) {
    covering_.options[option].certain = std::move(certain);
    covering_.options[option].uncertain = std::move(uncertain);
  }
  /// Gives each pixel's weight to the slots in proportion to the share of their options that are certain to
  /// leave it unexplained.
  void share_pixels();
  /// A further slot; its pixels weigh as those of `like`.
  std::size_t add_slot(int copies, std::size_t like);
  void set_slot(std::size_t option, std::size_t slot) {
    covering_.options[option].slot = static_cast<std::uint32_t>(slot);
  }
  void set_copies(std::size_t slot, int copies) { covering_.copies[slot] = copies; }

  /// Old numbers of what compact() left.
  struct Left : CoveringNumbers {
    std::vector<std::uint32_t> options;
  };
  /// Forgets dropped options and then, as perch::compact, points and pixels.
  Left compact();

  /// mu of a point.
  Weight point_weight(std::size_t point) const { return mu_[point]; }
  void set_point_weight(std::size_t point, Weight weight) { mu_[point] = weight; }
  /// beta and upsilon of a pixel.
  struct PixelWeight {
    Weight certain = 0, uncertain = 0;
  };
  /// Those of all slots together must be feasible.
  void set_pixel_weight(std::size_t slot, std::size_t pixel, PixelWeight weight) {
    charges_[slot].certain[pixel] = weight.certain;
    charges_[slot].uncertain[pixel] = weight.uncertain;
  }

 private:
  struct Slopes {
    int certain = 0, uncertain = 0;
  };
  /// Weights of the pixels, their sums from the first on, and scratch memory of step().
  struct Charges {
    std::vector<Weight> certain, uncertain;
    std::vector<Weight> certain_sums, uncertain_sums;
    std::vector<Slopes> slopes;
  };

  void sum_up(const Executor& executor);
  Weight value(std::size_t option) const;
  bool step(const std::vector<std::size_t>& best, double rise);
  void make_feasible(std::size_t pixel);

  Covering covering_;
  std::vector<char> kept_;
  std::int64_t lower_bound_ = 0;
  Weight base_ = 0;
  std::vector<Weight> reduced_;
  std::vector<std::size_t> best_;
  std::vector<Weight> mu_, mu_sums_;  ///< of the points, and summed up
  std::vector<Charges> charges_;      ///< by slot
  std::vector<Weight> total_sums_;    ///< of sum_n k_n upsilon_n

  // Scratch memory of step(): slopes of the points, pixels whose weights move, and which these are.
  std::vector<int> point_slopes_;
  std::vector<std::uint32_t> moved_;
  std::vector<char> touched_;
};

}  // namespace perch
