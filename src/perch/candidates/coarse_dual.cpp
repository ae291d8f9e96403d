#include "perch/candidates/coarse_dual.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "perch/candidates/relaxation.hpp"
#include "perch/core/instruction_set.hpp"

namespace perch {
namespace {

constexpr int side = 4;                       // of a block, pixels
constexpr std::int32_t coarse_one = 1 << 16;  // sums of a few hundred blocks fit 32 bits
constexpr Lagrangian::Weight finer = Lagrangian::one / coarse_one;
constexpr std::size_t nothing = static_cast<std::size_t>(-1);

/// A candidate's planes and the weights of its blocks.
struct WorthFrame {
  const std::uint8_t *explained, *certain, *uncertain, *relieved;
  const std::int32_t *mu, *certain_weight, *uncertain_weight, *relief;
  std::size_t pitch;
  int columns, rows;
};

}  // namespace
}  // namespace perch

#define PERCH_KERNELS "perch/candidates/coarse_dual.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {

CoarseDual::CoarseDual(const LocalizationProblem& problem)
    : problem_(problem),
      width_(problem.observation().intrinsics().width),
      columns_((width_ + side - 1) / side),
      rows_((problem.observation().intrinsics().height + side - 1) / side),
      pitch_(static_cast<std::size_t>(columns_) + lane_count),
      largest_(problem.kinds(), 0),
      charges_(problem.kinds()),
      relief_(problem.kinds()) {
  const std::size_t blocks = pitch_ * static_cast<std::size_t>(rows_);
  const Observation& observation = problem.observation();
  points_.assign(blocks, 0);
  block_of_point_.reserve(observation.size());
  for (int v = 0; v < observation.intrinsics().height; ++v)
    for (std::size_t i = observation.row_begin(v); i < observation.row_begin(v + 1); ++i) {
      const int column = observation.column(i) / side, row = v / side;
      block_of_point_.push_back({static_cast<std::uint16_t>(column), static_cast<std::uint16_t>(row)});
      points_[block_at(column, row)] += problem.cost().charges_points();
    }
  for (std::size_t b = 0; b < blocks; ++b)
    if (points_[b] > 0) with_points_.push_back(static_cast<std::uint32_t>(b));
  mu_.assign(blocks, problem.cost().charges_points() ? coarse_one : 0);
  best_mu_ = mu_;
  mu_slope_.assign(blocks, 0);
  touched_.assign(blocks, 0);
  charged_.assign(blocks, 0);
  std::int32_t copies = 0;
  for (const int k : problem.copies()) copies += k;
  for (Charges& charges : charges_) {
    charges.certain.assign(blocks, coarse_one / std::max(1, copies));
    charges.uncertain.assign(blocks, 0);
    charges.relief.assign(blocks, 0);
    charges.best_certain = charges.certain;
    charges.best_uncertain = charges.uncertain;
    charges.certain_slope.assign(blocks, 0);
    charges.uncertain_slope.assign(blocks, 0);
  }
}

void CoarseDual::add(const CandidateSet& set, const Executor& executor) {
  const std::size_t before = candidates_.size();
  candidates_.resize(set.size());
  executor.for_each(
      set.size() - before,
      [&](std::size_t i, std::size_t) {
        candidates_[before + i] = counts_of(set[static_cast<CandidateId>(before + i)]);
      },
      StopCondition());
}

CoarseDual::Counts CoarseDual::counts_of(const Candidate& candidate) const {
  Counts counts;
  counts.kind = problem_.kind_of(candidate.model);
  if (candidate.absent || candidate.window.empty()) return counts;
  // Points that it explains may be seen beside its rendering.
  const int margin = problem_.cost().index().reach();
  const Window w = intersection({candidate.window.u0 - margin, candidate.window.v0 - margin,
                                 candidate.window.u1 + margin, candidate.window.v1 + margin},
                                problem_.observation().intrinsics().window());
  counts.column = w.u0 / side;
  counts.row = w.v0 / side;
  counts.columns = ((w.u1 - 1) / side - counts.column + lane_count) / lane_count * lane_count;
  counts.rows = (w.v1 - 1) / side + 1 - counts.row;
  const auto size = static_cast<std::size_t>(counts.columns) * static_cast<std::size_t>(counts.rows);
  for (auto* plane : {&counts.explained, &counts.certain, &counts.uncertain, &counts.relieved})
    plane->assign(size, 0);
  const auto place = [&](int column, int row) {
    return static_cast<std::size_t>(row - counts.row) * static_cast<std::size_t>(counts.columns) +
           static_cast<std::size_t>(column - counts.column);
  };
  for (const Run& run : candidate.explained_runs)
    for (std::uint32_t i = run.first; i < run.last; ++i)
      ++counts.explained[place(block_of_point_[i].column, block_of_point_[i].row)];
  const auto count_pixels = [&](const std::vector<Run>& runs, std::vector<std::uint8_t>& plane) {
    for (const Run& run : runs) {
      int v = static_cast<int>(run.first) / width_, u = static_cast<int>(run.first) % width_;
      for (std::uint32_t x = run.first; x < run.last; ++x) {
        ++plane[place(u / side, v / side)];
        if (++u < width_) continue;
        u = 0;
        ++v;
      }
    }
  };
  count_pixels(candidate.certain_runs, counts.certain);
  count_pixels(candidate.uncertain_runs, counts.uncertain);
  count_pixels(candidate.explained_pixels, counts.relieved);
  return counts;
}

void CoarseDual::value_all(const Executor& executor) {
  constexpr std::size_t batch = 32;
  values_.resize(candidates_.size());
  for_each_batched(executor, candidates_.size(), batch, StopCondition(), [&](std::size_t i, std::size_t) {
    const Counts& c = candidates_[i];
    const Charges& charges = charges_[c.kind];
    const std::size_t corner = block_at(c.column, c.row);
    const WorthFrame frame{c.explained.data(),
                           c.certain.data(),
                           c.uncertain.data(),
                           c.relieved.data(),
                           mu_.data() + corner,
                           charges.certain.data() + corner,
                           charges.uncertain.data() + corner,
                           charges.relief.data() + corner,
                           pitch_,
                           c.columns,
                           c.rows};
    values_[i] = PERCH_CALL(worth, frame);
  });
}

void CoarseDual::ascend(int iterations, std::int64_t aim, double enough, const Executor& executor,
                        const StopCondition& stop) {
  std::optional<Weight> best_bound;
  Relaxation relaxation;
  for (int iteration = 0;; ++iteration) {
    value_all(executor);
    std::vector<std::size_t> best(charges_.size(), nothing);
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      std::size_t& first = best[candidates_[i].kind];
      if (first == nothing || values_[i] > values_[first]) first = i;
    }
    Weight bound = constant() / finer;
    std::vector<Weight> largest(charges_.size(), 0);
    for (std::size_t kind = 0; kind < best.size(); ++kind) {
      if (problem_.copies()[kind] == 0) continue;
      largest[kind] = values_[best[kind]] * finer;
      bound -= problem_.copies()[kind] * values_[best[kind]];
    }
    const bool gained = !best_bound || bound > *best_bound;
    relaxation.note(gained);
    if (gained) {
      best_bound = bound;
      largest_ = largest;
      remember();
    }
    const double whole = static_cast<double>(bound) / coarse_one;
    if (iteration == iterations || whole >= enough || relaxation.spent() || stop()) break;
    double target = static_cast<double>(aim);
    if (problem_.cost().charges_points())
      target = std::min(target, static_cast<double>(problem_.cost().charged_points()));
    if (!step(best, relaxation.share() * std::max(1.0, target - whole))) break;
  }
  recall();
  sum_relief();
}

/// Polyak's step along the subgradient of the bound at the best candidate of each kind. The weight of a
/// block stands for those of its pixels, so a slope counts by the pixel.
bool CoarseDual::step(const std::vector<std::size_t>& best, double rise) {
  for (const std::uint32_t b : with_points_) mu_slope_[b] = points_[b];
  moved_.clear();
  for (std::size_t kind = 0; kind < best.size(); ++kind) {
    const int copies = problem_.copies()[kind];
    if (copies == 0) continue;
    const Counts& c = candidates_[best[kind]];
    std::size_t i = 0;
    for (int row = 0; row < c.rows; ++row)
      for (int column = 0; column < c.columns; ++column, ++i) {
        const std::size_t block = block_at(c.column + column, c.row + row);
        mu_slope_[block] -= copies * c.explained[i];
        if ((c.certain[i] | c.uncertain[i] | c.relieved[i]) == 0) continue;
        if (!touched_[block]) moved_.push_back(static_cast<std::uint32_t>(block));
        touched_[block] = 1;
        charges_[kind].certain_slope[block] += copies * c.certain[i];
        charges_[kind].uncertain_slope[block] += copies * c.uncertain[i];
        for (std::size_t other = 0; other < charges_.size(); ++other) {
          const int relieved = copies * (problem_.copies()[other] - static_cast<int>(other == kind));
          if (problem_.copies()[other] > 0 && relieved > 0)
            charges_[other].uncertain_slope[block] -= relieved * c.relieved[i];
        }
      }
  }
  constexpr double pixels = side * side;
  double norm = 0.0;
  for (const std::uint32_t b : with_points_) {
    int& slope = mu_slope_[b];
    if ((slope > 0 && mu_[b] == coarse_one) || (slope < 0 && mu_[b] == 0)) slope = 0;
    if (slope != 0) norm += static_cast<double>(slope) * slope / points_[b];
  }
  for (Charges& charges : charges_)
    for (const std::uint32_t b : moved_) {
      int &certain = charges.certain_slope[b], &uncertain = charges.uncertain_slope[b];
      if (uncertain < 0 && charges.uncertain[b] == 0) uncertain = 0;
      norm += (static_cast<double>(certain) * certain + static_cast<double>(uncertain) * uncertain) / pixels;
    }
  const auto scaled = [length = norm > 0.0 ? rise / norm : 0.0](int slope, double number) {
    return static_cast<std::int32_t>(std::clamp(length * slope / number, -1.0, 1.0) * coarse_one);
  };
  for (const std::uint32_t b : with_points_)
    if (mu_slope_[b] != 0) mu_[b] = std::clamp(mu_[b] + scaled(mu_slope_[b], points_[b]), 0, coarse_one);
  for (Charges& charges : charges_)
    for (const std::uint32_t b : moved_) {
      charges.certain[b] += scaled(charges.certain_slope[b], pixels);
      charges.uncertain[b] = std::max(0, charges.uncertain[b] + scaled(charges.uncertain_slope[b], pixels));
      charges.certain_slope[b] = charges.uncertain_slope[b] = 0;
    }
  for (const std::uint32_t b : moved_) {
    make_feasible(b);
    update_relief(b);
    touched_[b] = 0;
    if (!charged_[b]) ever_charged_.push_back(b);
    charged_[b] = 1;
  }
  return norm > 0.0;
}

void CoarseDual::make_feasible(std::size_t block) {
  std::int64_t total = 0;
  for (std::size_t kind = 0; kind < charges_.size(); ++kind)
    total += std::int64_t{problem_.copies()[kind]} *
             (charges_[kind].certain[block] + charges_[kind].uncertain[block]);
  if (total <= coarse_one) return;
  const auto scale = [total](std::int32_t& weight) {
    weight = static_cast<std::int32_t>(std::int64_t{weight} * coarse_one / total);
  };
  for (Charges& charges : charges_) {
    scale(charges.certain[block]);
    scale(charges.uncertain[block]);
  }
}

void CoarseDual::update_relief(std::size_t block) {
  std::int32_t total = 0;
  for (std::size_t kind = 0; kind < charges_.size(); ++kind)
    total += problem_.copies()[kind] * charges_[kind].uncertain[block];
  for (Charges& charges : charges_) charges.relief[block] = total - charges.uncertain[block];
}

void CoarseDual::remember() {
  for (const std::uint32_t b : with_points_) best_mu_[b] = mu_[b];
  for (Charges& charges : charges_)
    for (const std::uint32_t b : ever_charged_) {
      charges.best_certain[b] = charges.certain[b];
      charges.best_uncertain[b] = charges.uncertain[b];
    }
}

void CoarseDual::recall() {
  for (const std::uint32_t b : with_points_) mu_[b] = best_mu_[b];
  for (Charges& charges : charges_)
    for (const std::uint32_t b : ever_charged_) {
      charges.certain[b] = charges.best_certain[b];
      charges.uncertain[b] = charges.best_uncertain[b];
    }
  for (const std::uint32_t b : ever_charged_) update_relief(b);
}

void CoarseDual::sum_relief() {
  for (std::size_t kind = 0; kind < charges_.size(); ++kind) {
    if (problem_.copies()[kind] == 0) continue;
    relief_[kind] = SummedArea({0, 0, columns_, rows_}, [&](int column, int row) {
      return Weight{charges_[kind].relief[block_at(column, row)]} * (finer * side * side);
    });
  }
}

CoarseDual::Weight CoarseDual::constant() const {
  Weight sum = 0;
  for (const std::uint32_t b : with_points_) sum += Weight{points_[b]} * mu_[b];
  return sum * finer;
}

std::vector<CoarseDual::Weight> CoarseDual::point_weights() const {
  std::vector<Weight> weights;
  weights.reserve(block_of_point_.size());
  for (const Place& place : block_of_point_)
    weights.push_back(mu_[block_at(place.column, place.row)] * finer);
  return weights;
}

CoarseDual::Weight CoarseDual::relief(std::size_t kind, const Window& window) const {
  return relief_[kind](
      {window.u0 / side, window.v0 / side, (window.u1 + side - 1) / side, (window.v1 + side - 1) / side});
}

Lagrangian::PixelWeight CoarseDual::pixel_weight(std::size_t kind, std::uint32_t pixel) const {
  const int v = static_cast<int>(pixel) / width_, u = static_cast<int>(pixel) % width_;
  const std::size_t block = block_at(u / side, v / side);
  return {charges_[kind].certain[block] * finer, charges_[kind].uncertain[block] * finer};
}

}  // namespace perch
