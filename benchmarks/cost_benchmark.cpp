// Valuing one object alone, beside the cost in general on an empty composite, k-d trees, and all pairs of
// points.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "kd_tree.hpp"
#include "observed_mug.hpp"
#include "perch/cost/lone_cost.hpp"

namespace perch {
namespace {

/// The counts that all of these agree on.
struct Counts {
  std::int64_t unexplained = 0, explained = 0;
  friend bool operator==(const Counts&, const Counts&) = default;
};

struct Valuing {
  ObservedMug mug;
  DeltaIndex index{mug.observation, 0.005, SerialExecutor()};
  ExplanationCost cost{mug.observation, index, CostSettings{}};
  Composite nothing = cost.empty();
  KdTree observed{mug.observation.points()};
  LoneCost lone{cost};
  LoneValue value;
  CostChange change;

  explicit Valuing(std::int64_t focal) : mug(static_cast<double>(focal)) {}

  Counts alone() {
    lone.value(mug.rendered, value);
    return {value.unexplained, value.explained_count};
  }
  Counts in_general() {
    cost.change(nothing, mug.rendered, change);
    return {change.unexplained, static_cast<std::int64_t>(change.gained.size())};
  }
  Counts by_trees() {
    const std::vector<Eigen::Vector3f> points = rendered_points();
    const KdTree rendered(points);
    const auto far_from = [&](const KdTree& tree) {
      return
          [&](const Eigen::Vector3f& p) { return tree.nearest(p).squared_distance > index.delta_squared(); };
    };
    return {std::count_if(points.begin(), points.end(), far_from(observed)), explained(far_from(rendered))};
  }
  Counts by_all_pairs() {
    const std::vector<Eigen::Vector3f> points = rendered_points();
    const auto far_from = [&](const std::vector<Eigen::Vector3f>& others) {
      return [&](const Eigen::Vector3f& p) {
        return std::none_of(others.begin(), others.end(), [&](const Eigen::Vector3f& q) {
          return within_delta(p, q, index.delta_squared());
        });
      };
    };
    return {std::count_if(points.begin(), points.end(), far_from(mug.observation.points())),
            explained(far_from(points))};
  }

 private:
  std::vector<Eigen::Vector3f> rendered_points() const {
    const RaySlopes& rays = mug.observation.rays();
    const Window& window = mug.rendered.window;
    std::vector<Eigen::Vector3f> points;
    for (int v = window.v0; v < window.v1; ++v)
      for (int u = window.u0; u < window.u1; ++u)
        if (const float z = mug.rendered.at(u, v); z < no_surface) points.push_back(rays.point(u, v, z));
    return points;
  }
  template <typename Far>
  std::int64_t explained(const Far& far) const {
    const auto& points = mug.observation.points();
    return static_cast<std::int64_t>(points.size()) - std::count_if(points.begin(), points.end(), far);
  }
};

void value(benchmark::State& state, Counts (Valuing::*counts)()) {
  Valuing valuing(state.range(0));
  if ((valuing.*counts)() != valuing.by_trees()) state.SkipWithError("the counts are not the same");
  for (auto _ : state) benchmark::DoNotOptimize((valuing.*counts)());
}

void focal_lengths(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("focal_length")->Arg(525)->Arg(1067)->Unit(benchmark::kMicrosecond);
}
BENCHMARK_CAPTURE(value, , &Valuing::alone)->Name("value_alone/kernel")->Apply(focal_lengths);
BENCHMARK_CAPTURE(value, , &Valuing::in_general)->Name("value_alone/in general")->Apply(focal_lengths);
BENCHMARK_CAPTURE(value, , &Valuing::by_trees)->Name("value_alone/k-d trees")->Apply(focal_lengths);
BENCHMARK_CAPTURE(value, , &Valuing::by_all_pairs)
    ->Name("value_alone/all pairs")
    ->ArgName("focal_length")
    ->Arg(525)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace perch
