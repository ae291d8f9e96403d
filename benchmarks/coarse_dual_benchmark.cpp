// What candidates are worth by weights that are the same all over a block of pixels, from counts of each
// block, beside sums over every point and pixel. The kernel's time holds what the bound at the weights takes
// besides.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "perch/candidates/coarse_dual.hpp"
#include "perch/candidates/fixed_candidates.hpp"
#include "perch/localize/setup.hpp"
#include "perch/sim/scene_generator.hpp"

namespace perch {
namespace {

/// Three objects on a table and the candidates of a wide grid, at weights that a few steps have moved.
struct Weighed {
  SerialExecutor executor;
  std::unique_ptr<LocalizationProblem> problem = make_problem(scene(), settings(), executor);
  std::vector<CandidateMaker> makers = make_makers(*problem, executor);
  FixedCandidates candidates{*problem, makers, executor};
  CoarseDual dual{*problem};
  // Of the points, and of each model's pixels.
  std::vector<Lagrangian::Weight> mu;
  std::vector<std::vector<Lagrangian::Weight>> certain, uncertain, relief;

  Weighed() {
    candidates.refine(StopCondition());
    candidates.value_all(StopCondition());
    dual.add(candidates.set(), executor);
    ascend(20);
    mu = dual.point_weights();
    const Intrinsics& intrinsics = problem->observation().intrinsics();
    const auto pixels = static_cast<std::uint32_t>(intrinsics.width * intrinsics.height);
    std::vector<Lagrangian::Weight> total(pixels, 0);
    for (std::size_t model = 0; model < problem->models().size(); ++model) {
      certain.emplace_back();
      uncertain.emplace_back();
      for (std::uint32_t x = 0; x < pixels; ++x) {
        const Lagrangian::PixelWeight weight = dual.pixel_weight(model, x);
        certain.back().push_back(weight.certain);
        uncertain.back().push_back(weight.uncertain);
        total[x] += problem->copies()[model] * weight.uncertain;
      }
    }
    for (const auto& own : uncertain) {
      relief.push_back(total);
      for (std::uint32_t x = 0; x < pixels; ++x) relief.back()[x] -= own[x];
    }
  }

  /// At most `steps` steps; what candidates are worth is found out once more than that.
  void ascend(int steps) {
    dual.ascend(steps, 0, std::numeric_limits<double>::infinity(), executor, StopCondition());
  }
  std::vector<Lagrangian::Weight> by_blocks() {
    ascend(0);
    return dual.largest();
  }

  std::vector<Lagrangian::Weight> one_by_one() const {
    const auto sum = [](const std::vector<Run>& runs, const std::vector<Lagrangian::Weight>& weights) {
      Lagrangian::Weight all = 0;
      for (const Run& run : runs)
        for (std::uint32_t i = run.first; i < run.last; ++i) all += weights[i];
      return all;
    };
    std::vector<Lagrangian::Weight> most(problem->models().size(),
                                         std::numeric_limits<Lagrangian::Weight>::min());
    for (CandidateId id = 0; id < candidates.set().size(); ++id) {
      const Candidate& c = candidates.set()[id];
      most[c.model] =
          std::max(most[c.model], sum(c.explained_runs, mu) - sum(c.certain_runs, certain[c.model]) -
                                      sum(c.uncertain_runs, uncertain[c.model]) +
                                      sum(c.explained_pixels, relief[c.model]));
    }
    return most;
  }

 private:
  static Scene scene() {
    TabletopOptions options;
    options.min_objects = options.max_objects = 3;
    options.repeats = false;
    return random_tabletop(1, options).scene;
  }
  static Settings settings() {
    Settings settings;
    settings.candidates.grid.resolution = 0.08;
    return settings;
  }
};

/// Made once: it takes longer than it is timed.
Weighed& weighed() {
  static Weighed weighed;
  return weighed;
}

void value_by_blocks(benchmark::State& state) {
  if (weighed().by_blocks() != weighed().one_by_one()) state.SkipWithError("the values are not the same");
  for (auto _ : state) benchmark::DoNotOptimize(weighed().by_blocks());
}
BENCHMARK(value_by_blocks)->Name("coarse_dual/kernel")->Unit(benchmark::kMicrosecond);

void value_one_by_one(benchmark::State& state) {
  weighed();
  for (auto _ : state) benchmark::DoNotOptimize(weighed().one_by_one());
}
BENCHMARK(value_one_by_one)->Name("coarse_dual/one by one")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace perch
