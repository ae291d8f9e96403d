#include "perch/candidates/lagrangian_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace perch {
namespace {

constexpr int patience = 4;  // iterations without a better bound before the step is halved
constexpr double least_relaxation = 0.02;

}  // namespace

LagrangianBound::LagrangianBound(const LocalizationProblem& problem, const CandidateSet& set)
    : problem_(problem),
      set_(set),
      certain_(set.size()),
      kept_(set.size(), 0),
      slot_of_(set.size(), 0),
      reduced_costs_(set.size()),
      mu_(problem.observation().size(), one),
      mu_sums_(mu_.size() + 1, 0) {
  const auto width = static_cast<std::size_t>(problem.observation().intrinsics().width);
  Window covered;
  for (std::size_t model = 0; model < problem.models().size(); ++model)
    if (problem.copies()[model] > 0)
      for (const CandidateId id : set.of_model(model)) covered = bounding(covered, set[id].window);
  if (!covered.empty()) {
    first_pixel_ = static_cast<std::size_t>(covered.v0) * width;
    pixels_ = static_cast<std::size_t>(covered.height()) * width;
  }
  for (std::size_t model = 0; model < problem.models().size(); ++model) {
    if (problem.copies()[model] == 0) continue;
    const std::size_t slot = add_slot(problem.copies()[model]);
    for (const CandidateId id : set.of_model(model)) {
      kept_[id] = 1;
      slot_of_[id] = slot;
      certain_[id] = set[id].certain_runs;
    }
  }
}

std::size_t LagrangianBound::add_slot(int copies) {
  const Weight share = one / static_cast<Weight>(problem_.object_count());
  slots_.push_back({copies, std::vector<Weight>(pixels_, share), std::vector<Weight>(pixels_ + 1, 0)});
  return slots_.size() - 1;
}

std::size_t LagrangianBound::kept_count() const {
  return static_cast<std::size_t>(std::count(kept_.begin(), kept_.end(), 1));
}

std::vector<CandidateId> LagrangianBound::left() const {
  std::vector<CandidateId> ids;
  for (CandidateId id = 0; id < set_.size(); ++id)
    if (kept_[id]) ids.push_back(id);
  return ids;
}

void LagrangianBound::sum_up() {
  for (std::size_t p = 0; p < mu_.size(); ++p) mu_sums_[p + 1] = mu_sums_[p] + mu_[p];
  for (Slot& slot : slots_)
    for (std::size_t x = 0; x < slot.nu.size(); ++x) slot.sums[x + 1] = slot.sums[x] + slot.nu[x];
}

LagrangianBound::Weight LagrangianBound::value(CandidateId id) const {
  Weight sum = 0;
  for (const Run& run : set_[id].explained_runs) sum += mu_sums_[run.last] - mu_sums_[run.first];
  const std::vector<Weight>& sums = slots_[slot_of_[id]].sums;
  for (const Run& run : certain_[id]) sum -= sums[pixel(run.last)] - sums[pixel(run.first)];
  return sum;
}

void LagrangianBound::improve(int iterations, std::int64_t upper_bound, double enough,
                              const Executor& executor, const StopCondition& stop) {
  constexpr std::size_t batch = 32;
  std::vector<CandidateId> ids = left();
  std::vector<Weight> values(set_.size(), 0);
  int without_gain = 0;
  double relaxation = 1.0;
  Weight best_bound = std::numeric_limits<Weight>::min();
  for (int iteration = 0; iteration < iterations && static_cast<double>(lower_bound_) < enough; ++iteration) {
    sum_up();
    const auto value_batch = [&](std::size_t b, std::size_t) {
      for (std::size_t i = b * batch; i < std::min(ids.size(), (b + 1) * batch); ++i)
        values[ids[i]] = value(ids[i]);
    };
    if (!executor.for_each((ids.size() + batch - 1) / batch, value_batch, stop)) return;

    std::vector<CandidateId> best(slots_.size(), 0);
    std::vector<char> found(slots_.size(), 0);
    for (const CandidateId id : ids) {
      const std::size_t slot = slot_of_[id];
      if (found[slot] == 0 || values[id] > values[best[slot]]) best[slot] = id;
      found[slot] = 1;
    }
    Weight bound = mu_sums_.back();  // |I| - sum (1 - mu)
    for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
      if (slots_[slot].copies == 0) continue;
      if (found[slot] == 0) {  // no scene is left that costs less than the upper bound
        lower_bound_ = std::max(lower_bound_, upper_bound);
        return;
      }
      bound -= slots_[slot].copies * values[best[slot]];
    }
    lower_bound_ = std::max(lower_bound_, ReducedCosts::count(bound));
    if (bound > reduced_costs_.base_) {
      reduced_costs_.base_ = bound;
      for (const CandidateId id : ids) reduced_costs_.reduced_[id] = values[best[slot_of_[id]]] - values[id];
    }
    const std::size_t before = ids.size();
    std::erase_if(ids, [&](CandidateId id) {
      const bool drop = bound + values[best[slot_of_[id]]] - values[id] > (upper_bound - 1) * one;
      if (drop) kept_[id] = 0;
      return drop;
    });
    if (bound > best_bound || ids.size() < before) {
      best_bound = std::max(best_bound, bound);
      without_gain = 0;
    } else if (++without_gain == patience) {
      without_gain = 0;
      relaxation *= 0.5;
      if (relaxation < least_relaxation) return;
    }
    const double gap =
        static_cast<double>(upper_bound) - static_cast<double>(bound) / static_cast<double>(one);
    if (!step(best, relaxation * std::max(1.0, gap))) return;
  }
}

bool LagrangianBound::step(const std::vector<CandidateId>& best, double rise) {
  // Polyak's step along the subgradient: 1 - (how often a point is explained) for mu; B of the best candidate
  // for nu.
  std::vector<int> explained(mu_.size(), 0);
  double norm = 0.0;
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    const int copies = slots_[slot].copies;
    if (copies == 0) continue;
    for (const Run& run : set_[best[slot]].explained_runs)
      for (std::uint32_t p = run.first; p < run.last; ++p) explained[p] += copies;
    for (const Run& run : certain_[best[slot]])
      norm += static_cast<double>(copies * copies) * (run.last - run.first);
  }
  for (const int times : explained) norm += static_cast<double>((1 - times) * (1 - times));
  if (norm == 0.0) return false;
  const auto scaled = [length = rise / norm](int slope) {
    return static_cast<Weight>(std::clamp(length * slope, -1.0, 1.0) * static_cast<double>(one));
  };
  for (std::size_t p = 0; p < mu_.size(); ++p)
    mu_[p] = std::clamp<Weight>(mu_[p] + scaled(1 - explained[p]), 0, one);
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    const int copies = slots_[slot].copies;
    if (copies == 0) continue;
    for (const Run& run : certain_[best[slot]])
      for (std::uint32_t image_pixel = run.first; image_pixel < run.last; ++image_pixel) {
        const std::size_t x = pixel(image_pixel);
        slots_[slot].nu[x] += scaled(copies);
        Weight total = 0;
        for (const Slot& other : slots_) total += other.copies * other.nu[x];
        if (total <= one) continue;
        for (Slot& other : slots_)  // back to the feasible side; rounded down, it stays there
          other.nu[x] = static_cast<Weight>(static_cast<__int128>(other.nu[x]) * one / total);
      }
  }
  return true;
}

}  // namespace perch
