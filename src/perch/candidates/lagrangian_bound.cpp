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
      reduced_costs_(set.size()),
      mu_(problem.observation().size(), one),
      mu_sums_(mu_.size() + 1, 0),
      nu_(problem.models().size()),
      nu_sums_(problem.models().size()) {
  const auto width = static_cast<std::size_t>(problem.observation().intrinsics().width);
  Window covered;
  for (std::size_t model = 0; model < problem.models().size(); ++model)
    for (const CandidateId id : set.of_model(model)) {
      if (problem.copies()[model] == 0) continue;
      kept_[id] = 1;
      certain_[id] = set[id].certain_runs;
      covered = bounding(covered, set[id].window);
    }
  if (!covered.empty()) {
    first_pixel_ = static_cast<std::size_t>(covered.v0) * width;
    pixels_ = static_cast<std::size_t>(covered.height()) * width;
  }
  const Weight share = one / static_cast<Weight>(problem.object_count());
  for (std::size_t model = 0; model < nu_.size(); ++model) {
    if (problem.copies()[model] == 0) continue;
    nu_[model].assign(pixels_, share);
    nu_sums_[model].assign(pixels_ + 1, 0);
  }
}

std::size_t LagrangianBound::kept_count() const {
  return static_cast<std::size_t>(std::count(kept_.begin(), kept_.end(), 1));
}

std::size_t LagrangianBound::pixel(std::uint32_t image_pixel) const {
  return image_pixel - first_pixel_;
}

void LagrangianBound::sum_up() {
  for (std::size_t p = 0; p < mu_.size(); ++p) mu_sums_[p + 1] = mu_sums_[p] + mu_[p];
  for (std::size_t model = 0; model < nu_.size(); ++model)
    for (std::size_t x = 0; x < nu_[model].size(); ++x)
      nu_sums_[model][x + 1] = nu_sums_[model][x] + nu_[model][x];
}

LagrangianBound::Weight LagrangianBound::value(const Candidate& candidate) const {
  Weight sum = 0;
  for (const Run& run : candidate.explained_runs) sum += mu_sums_[run.last] - mu_sums_[run.first];
  return sum;
}

void LagrangianBound::improve(int iterations, std::int64_t upper_bound, double enough,
                              const Executor& executor, const StopCondition& stop) {
  const auto points = static_cast<Weight>(mu_.size());
  std::vector<Weight> values(set_.size(), 0);
  std::vector<CandidateId> left;
  for (CandidateId id = 0; id < set_.size(); ++id)
    if (kept_[id]) left.push_back(id);
  constexpr std::size_t batch = 32;
  int without_gain = 0;
  double relaxation = 1.0;
  Weight best_bound = std::numeric_limits<Weight>::min();
  for (int iteration = 0; iteration < iterations && static_cast<double>(lower_bound_) < enough; ++iteration) {
    sum_up();
    const bool complete =
        executor.for_each((left.size() + batch - 1) / batch,
                          [&](std::size_t b, std::size_t) {
                            for (std::size_t i = b * batch; i < std::min(left.size(), (b + 1) * batch); ++i) {
                              const Candidate& candidate = set_[left[i]];
                              Weight v = value(candidate);
                              const auto& sums = nu_sums_[candidate.model];
                              for (const Run& run : certain_[left[i]])
                                v -= sums[pixel(run.last)] - sums[pixel(run.first)];
                              values[left[i]] = v;
                            }
                          },
                          stop);
    if (!complete) return;

    std::vector<CandidateId> best(problem_.models().size(), 0);
    std::vector<char> found(problem_.models().size(), 0);
    for (const CandidateId id : left) {
      const std::size_t model = set_[id].model;
      if (found[model] == 0 || values[id] > values[best[model]]) best[model] = id;
      found[model] = 1;
    }
    Weight bound = points * one - (points * one - mu_sums_.back());
    bool empty_slot = false;
    for (std::size_t model = 0; model < found.size(); ++model) {
      if (problem_.copies()[model] == 0) continue;
      if (found[model] == 0)
        empty_slot = true;
      else
        bound -= problem_.copies()[model] * values[best[model]];
    }
    if (empty_slot) {  // every scene costs at least the upper bound
      lower_bound_ = std::max(lower_bound_, upper_bound);
      return;
    }
    lower_bound_ = std::max(lower_bound_, ReducedCosts::count(bound));
    if (bound > reduced_costs_.base_) {
      reduced_costs_.base_ = bound;
      for (const CandidateId id : left)
        reduced_costs_.reduced_[id] = values[best[set_[id].model]] - values[id];
    }
    const std::size_t before = left.size();
    std::erase_if(left, [&](CandidateId id) {
      const Weight with = bound + values[best[set_[id].model]] - values[id];
      const bool drop = with > (upper_bound - 1) * one;
      if (drop) kept_[id] = 0;
      return drop;
    });
    if (bound > best_bound || left.size() < before) {
      best_bound = std::max(best_bound, bound);
      without_gain = 0;
    } else if (++without_gain == patience) {
      without_gain = 0;
      relaxation *= 0.5;
      if (relaxation < least_relaxation) return;
    }
    step(best, relaxation * std::max(1.0, static_cast<double>(upper_bound) -
                                              static_cast<double>(bound) / static_cast<double>(one)));
  }
}

void LagrangianBound::step(const std::vector<CandidateId>& best, double rise) {
  // Polyak's step along the subgradient: 1 - (how often a point is explained) for mu; B of the best candidate
  // for nu.
  std::vector<int> explained(mu_.size(), 0);
  double norm = 0.0;
  for (std::size_t model = 0; model < best.size(); ++model) {
    const int copies = problem_.copies()[model];
    if (copies == 0) continue;
    for (const Run& run : set_[best[model]].explained_runs)
      for (std::uint32_t p = run.first; p < run.last; ++p) explained[p] += copies;
    for (const Run& run : certain_[best[model]])
      norm += static_cast<double>(copies * copies) * (run.last - run.first);
  }
  for (const int times : explained) norm += static_cast<double>((1 - times) * (1 - times));
  if (norm == 0.0) return;
  const double length = rise / norm;
  const auto scaled = [&](int slope) {
    return static_cast<Weight>(std::clamp(length * slope, -1.0, 1.0) * static_cast<double>(one));
  };
  for (std::size_t p = 0; p < mu_.size(); ++p)
    mu_[p] = std::clamp<Weight>(mu_[p] + scaled(1 - explained[p]), 0, one);
  for (std::size_t model = 0; model < best.size(); ++model) {
    const int copies = problem_.copies()[model];
    if (copies == 0) continue;
    for (const Run& run : certain_[best[model]])
      for (std::uint32_t image_pixel = run.first; image_pixel < run.last; ++image_pixel) {
        const std::size_t x = pixel(image_pixel);
        nu_[model][x] += scaled(copies);
        Weight total = 0;
        for (std::size_t m = 0; m < nu_.size(); ++m)
          if (!nu_[m].empty()) total += problem_.copies()[m] * nu_[m][x];
        if (total <= one) continue;
        for (std::size_t m = 0; m < nu_.size();
             ++m)  // back to the feasible side; rounded down, it stays there
          if (!nu_[m].empty())
            nu_[m][x] = static_cast<Weight>(static_cast<__int128>(nu_[m][x]) * one / total);
      }
  }
}

void LagrangianBound::widen_certain(std::vector<CandidateMaker>& makers, const Executor& executor) {
  const Intrinsics& intrinsics = problem_.observation().intrinsics();
  const auto width = static_cast<std::size_t>(intrinsics.width);
  const int first_row = static_cast<int>(first_pixel_ / width);
  // The nearest that the candidates left of each model can be at a pixel.
  std::vector<std::vector<float>> nearest(nu_.size());
  std::vector<std::size_t> present;
  for (std::size_t model = 0; model < nu_.size(); ++model) {
    if (problem_.copies()[model] == 0) continue;
    present.push_back(model);
    nearest[model].assign(pixels_, no_surface);
  }
  const StopCondition never;
  executor.for_each(
      present.size(),
      [&](std::size_t k, std::size_t worker) {
        const std::size_t model = present[k];
        for (const CandidateId id : set_.of_model(model)) {
          if (!kept_[id]) continue;
          const DepthPatch& patch = makers[worker].patch(set_[id]);
          for (int v = patch.window.v0; v < patch.window.v1; ++v)
            for (int u = patch.window.u0; u < patch.window.u1; ++u) {
              float& z = nearest[model][static_cast<std::size_t>(v - first_row) * width +
                                        static_cast<std::size_t>(u)];
              z = std::min(z, patch.at(u, v));
            }
        }
      },
      never);
  std::vector<CandidateId> left;
  for (CandidateId id = 0; id < set_.size(); ++id)
    if (kept_[id]) left.push_back(id);
  executor.for_each(
      left.size(),
      [&](std::size_t i, std::size_t worker) {
        const Candidate& candidate = set_[left[i]];
        const DepthPatch& patch = makers[worker].patch(candidate);
        std::vector<Run> runs;
        for (int v = patch.window.v0; v < patch.window.v1; ++v)
          for (int u = patch.window.u0; u < patch.window.u1; ++u) {
            const float z = patch.at(u, v);
            if (!(z < no_surface) || !problem_.cost().counts_at(u, v)) continue;
            const std::size_t x =
                static_cast<std::size_t>(v - first_row) * width + static_cast<std::size_t>(u);
            const auto in_front = [&](std::size_t model) {
              return (model != candidate.model || problem_.copies()[model] > 1) && nearest[model][x] < z;
            };
            const DeltaIndex& index = problem_.cost().index();
            if (!index.unexplained_throughout(u, v, z, z) &&
                (index.explained(u, v, z) || std::any_of(present.begin(), present.end(), in_front)))
              continue;
            append(runs, static_cast<std::uint32_t>(first_pixel_ + x));
          }
        certain_[left[i]] = std::move(runs);
      },
      never);
}

}  // namespace perch
