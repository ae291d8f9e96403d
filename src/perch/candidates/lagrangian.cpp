#include "perch/candidates/lagrangian.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "perch/candidates/relaxation.hpp"

namespace perch {
namespace {

constexpr std::size_t nothing = static_cast<std::size_t>(-1);

}  // namespace

Lagrangian::Lagrangian(Covering covering)
    : covering_(std::move(covering)),
      kept_(covering_.options.size(), 1),
      lower_bound_(covering_.fixed),
      base_(covering_.fixed * one),
      reduced_(covering_.options.size(), 0),
      best_(covering_.copies.size(), nothing),
      mu_(covering_.points, one),
      mu_sums_(covering_.points + 1, 0) {
  Weight all = 0;
  for (const int copies : covering_.copies) all += copies;
  const std::vector<Weight> none(covering_.pixels, 0), sums(covering_.pixels + 1, 0);
  for (std::size_t slot = 0; slot < covering_.copies.size(); ++slot)
    charges_.push_back({std::vector<Weight>(covering_.pixels, all == 0 ? 0 : one / all), none, sums, sums,
                        std::vector<Slopes>(covering_.pixels)});
  total_sums_ = sums;
  touched_.assign(covering_.pixels, 0);
}

std::size_t Lagrangian::kept_count() const {
  return static_cast<std::size_t>(std::count(kept_.begin(), kept_.end(), 1));
}

std::size_t Lagrangian::add_slot(int copies, std::size_t like) {
  covering_.copies.push_back(copies);
  charges_.push_back(Charges(charges_[like]));
  best_.push_back(nothing);
  return covering_.copies.size() - 1;
}

void Lagrangian::sum_up(const Executor& executor) {
  const StopCondition never;
  executor.for_each(
      charges_.size() + 1,
      [&](std::size_t slot, std::size_t) {
        if (slot == charges_.size()) {
          for (std::size_t p = 0; p < mu_.size(); ++p) mu_sums_[p + 1] = mu_sums_[p] + mu_[p];
          return;
        }
        if (covering_.copies[slot] == 0) return;
        Charges& charges = charges_[slot];
        for (std::size_t x = 0; x < covering_.pixels; ++x) {
          charges.certain_sums[x + 1] = charges.certain_sums[x] + charges.certain[x];
          charges.uncertain_sums[x + 1] = charges.uncertain_sums[x] + charges.uncertain[x];
        }
      },
      never);
  std::fill(total_sums_.begin(), total_sums_.end(), 0);
  for (std::size_t slot = 0; slot < charges_.size(); ++slot) {
    const Weight copies = covering_.copies[slot];
    if (copies == 0) continue;
    const std::vector<Weight>& sums = charges_[slot].uncertain_sums;
    for (std::size_t x = 1; x < sums.size(); ++x) total_sums_[x] += copies * sums[x];
  }
}

Lagrangian::Weight Lagrangian::value(std::size_t index) const {
  const auto sum_of = [](const std::vector<Run>& runs, const std::vector<Weight>& sums) {
    Weight sum = 0;
    for (const Run& run : runs) sum += sums[run.last] - sums[run.first];
    return sum;
  };
  const Covering::Option& option = covering_.options[index];
  const Charges& charges = charges_[option.slot];
  return sum_of(option.explained, mu_sums_) - sum_of(option.certain, charges.certain_sums) -
         sum_of(option.uncertain, charges.uncertain_sums) + sum_of(option.relieved, total_sums_) -
         sum_of(option.relieved, charges.uncertain_sums);
}

void Lagrangian::improve(int iterations, std::int64_t upper_bound, double enough, const Executor& executor,
                         const StopCondition& stop) {
  constexpr std::size_t batch = 32;
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < kept_.size(); ++i)
    if (kept_[i]) left.push_back(i);
  std::vector<Weight> values(kept_.size(), 0);
  Relaxation relaxation;
  Weight best_bound = 0;
  for (int iteration = 0; iteration < iterations && static_cast<double>(lower_bound_) < enough; ++iteration) {
    sum_up(executor);
    if (!for_each_batched(executor, left.size(), batch, stop,
                          [&](std::size_t i, std::size_t) { values[left[i]] = value(left[i]); }))
      return;

    std::vector<std::size_t> best(covering_.copies.size(), nothing);
    for (const std::size_t i : left) {
      std::size_t& first = best[covering_.options[i].slot];
      if (first == nothing || values[i] > values[first]) first = i;
    }
    best_ = best;
    Weight bound = covering_.fixed * one + mu_sums_.back();  // |I| - sum (1 - mu)
    for (std::size_t slot = 0; slot < best.size(); ++slot) {
      if (covering_.copies[slot] == 0) continue;
      if (best[slot] == nothing) {  // no choice is left that costs less than the upper bound
        lower_bound_ = std::max(lower_bound_, upper_bound);
        return;
      }
      bound -= covering_.copies[slot] * values[best[slot]];
    }
    const auto deficit = [&](std::size_t i) { return values[best[covering_.options[i].slot]] - values[i]; };
    lower_bound_ = std::max(lower_bound_, count(bound));
    if (bound > base_) {
      base_ = bound;
      std::fill(reduced_.begin(), reduced_.end(), 0);
      for (const std::size_t i : left) reduced_[i] = deficit(i);
    }
    const std::size_t before = left.size();
    std::erase_if(left, [&](std::size_t i) {
      const bool drop = bound + deficit(i) > (upper_bound - 1) * one;
      if (drop) kept_[i] = 0;
      return drop;
    });
    relaxation.note(bound > best_bound || left.size() < before);
    best_bound = std::max(best_bound, bound);
    if (relaxation.spent()) return;
    // Without a known choice the step aims at what choosing nothing would cost.
    const std::int64_t aim =
        std::min(upper_bound, covering_.fixed + static_cast<std::int64_t>(covering_.points));
    const double gap = static_cast<double>(aim) - static_cast<double>(bound) / static_cast<double>(one);
    if (!step(best, relaxation.share() * std::max(1.0, gap))) return;
  }
}

bool Lagrangian::step(const std::vector<std::size_t>& best, double rise) {
  // Polyak's step along the subgradient of the bound, at the best option of each slot. Weights at the end of
  // their range that the step would push beyond it take no part.
  const auto for_each = [](const std::vector<Run>& runs, auto visit) {
    for (const Run& run : runs)
      for (std::uint32_t i = run.first; i < run.last; ++i) visit(i);
  };
  point_slopes_.assign(mu_.size(), 1);
  moved_.clear();
  const auto change = [&](int& slope, std::uint32_t x, int by) {
    slope += by;
    if (!touched_[x]) moved_.push_back(x);
    touched_[x] = 1;
  };
  for (std::size_t slot = 0; slot < best.size(); ++slot) {
    const int copies = covering_.copies[slot];
    if (copies == 0) continue;
    const Covering::Option& option = covering_.options[best[slot]];
    Charges& charges = charges_[slot];
    for_each(option.explained, [&](std::uint32_t p) { point_slopes_[p] -= copies; });
    for_each(option.certain, [&](std::uint32_t x) { change(charges.slopes[x].certain, x, copies); });
    for_each(option.uncertain, [&](std::uint32_t x) { change(charges.slopes[x].uncertain, x, copies); });
    for (std::size_t other = 0; other < charges_.size(); ++other) {
      const int relieved = copies * (covering_.copies[other] - static_cast<int>(other == slot));
      if (covering_.copies[other] > 0 && relieved > 0)
        for_each(option.relieved,
                 [&](std::uint32_t x) { change(charges_[other].slopes[x].uncertain, x, -relieved); });
    }
  }
  double norm = 0.0;
  for (std::size_t p = 0; p < mu_.size(); ++p) {
    int& slope = point_slopes_[p];
    if ((slope > 0 && mu_[p] == one) || (slope < 0 && mu_[p] == 0)) slope = 0;
    norm += static_cast<double>(slope * slope);
  }
  for (Charges& charges : charges_)
    for (const std::uint32_t x : moved_) {
      auto& [certain, uncertain] = charges.slopes[x];
      if (uncertain < 0 && charges.uncertain[x] == 0) uncertain = 0;
      norm += static_cast<double>(certain * certain + uncertain * uncertain);
    }
  const auto scaled = [length = norm > 0.0 ? rise / norm : 0.0](int slope) {
    return static_cast<Weight>(std::clamp(length * slope, -1.0, 1.0) * static_cast<double>(one));
  };
  for (std::size_t p = 0; p < mu_.size(); ++p)
    if (point_slopes_[p] != 0) mu_[p] = std::clamp<Weight>(mu_[p] + scaled(point_slopes_[p]), 0, one);
  for (Charges& charges : charges_)
    for (const std::uint32_t x : moved_) {
      auto& [certain, uncertain] = charges.slopes[x];
      charges.certain[x] += scaled(certain);
      charges.uncertain[x] = std::max<Weight>(0, charges.uncertain[x] + scaled(uncertain));
      certain = uncertain = 0;
    }
  for (const std::uint32_t x : moved_) {
    make_feasible(x);
    touched_[x] = 0;
  }
  return norm > 0.0;
}

/// Brings a pixel's weights back to a sum of at most one; rounded down, they stay there.
void Lagrangian::make_feasible(std::size_t x) {
  Weight total = 0;
  for (std::size_t slot = 0; slot < charges_.size(); ++slot)
    total += covering_.copies[slot] * (charges_[slot].certain[x] + charges_[slot].uncertain[x]);
  if (total <= one) return;
  const auto scale = [total](Weight& weight) {
    weight = static_cast<Weight>(static_cast<__int128>(weight) * one / total);
  };
  for (Charges& charges : charges_) {
    scale(charges.certain[x]);
    scale(charges.uncertain[x]);
  }
}

namespace {

template <typename T>
void keep_only(std::vector<T>& values, const std::vector<std::uint32_t>& left) {
  std::vector<T> kept;
  kept.reserve(left.size());
  for (const std::uint32_t i : left) kept.push_back(std::move(values[i]));
  values = std::move(kept);
}

}  // namespace

Lagrangian::Left Lagrangian::compact() {
  Left left;
  for (std::size_t i = 0; i < kept_.size(); ++i)
    if (kept_[i]) left.options.push_back(static_cast<std::uint32_t>(i));
  keep_only(covering_.options, left.options);
  keep_only(reduced_, left.options);
  kept_.assign(left.options.size(), 1);
  std::fill(best_.begin(), best_.end(), nothing);

  static_cast<CoveringNumbers&>(left) = perch::compact(covering_);
  keep_only(mu_, left.points);
  mu_sums_.assign(covering_.points + 1, 0);
  for (Charges& charges : charges_) {
    keep_only(charges.certain, left.pixels);
    keep_only(charges.uncertain, left.pixels);
    charges.certain_sums.assign(covering_.pixels + 1, 0);
    charges.uncertain_sums.assign(covering_.pixels + 1, 0);
    charges.slopes.assign(covering_.pixels, Slopes());
  }
  total_sums_.assign(covering_.pixels + 1, 0);
  touched_.assign(covering_.pixels, 0);
  return left;
}

void Lagrangian::share_pixels() {
  std::vector<double> options(charges_.size(), 0.0);
  for (std::size_t i = 0; i < kept_.size(); ++i)
    if (kept_[i]) options[covering_.options[i].slot] += 1.0;
  std::vector<std::vector<double>> share(charges_.size(), std::vector<double>(covering_.pixels, 0.0));
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    if (!kept_[i]) continue;
    const std::uint32_t slot = covering_.options[i].slot;
    for (const Run& run : covering_.options[i].certain)
      for (std::uint32_t x = run.first; x < run.last; ++x) share[slot][x] += 1.0 / options[slot];
  }
  for (std::size_t x = 0; x < covering_.pixels; ++x) {
    double total = 0.0;
    for (std::size_t slot = 0; slot < charges_.size(); ++slot)
      total += covering_.copies[slot] * share[slot][x];
    if (total == 0.0) continue;
    for (std::size_t slot = 0; slot < charges_.size(); ++slot) {
      charges_[slot].certain[x] = static_cast<Weight>(static_cast<double>(one) * share[slot][x] / total);
      charges_[slot].uncertain[x] = 0;
    }
    make_feasible(x);  // what rounding may have put on top
  }
}

}  // namespace perch
