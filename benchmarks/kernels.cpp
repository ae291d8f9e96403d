// The inner loops of valuing a hypothesis, each beside a plain implementation that gives the same answer.

#include <benchmark/benchmark.h>

#include "perch/core/instruction_set.hpp"
#include "perch/cost/lone_cost.hpp"
#include "perch/refine/icp.hpp"
#include "perch/render/rasterizer.hpp"
#include "perch/render/reference_drawing_test_support.hpp"
#include "perch/sim/parametric_models.hpp"

namespace perch {
namespace {

/// A mug 0.8 m away, seen from above, as observed and as rendered 3 mm aside.
struct Bench {
  Camera camera;
  Mesh mesh = mug_mesh();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity(), aside;
  Rasterizer rasterizer;

  explicit Bench(double focal = 525.0)
      : camera{{640, 480, focal, focal, 319.5, 239.5}, Eigen::Isometry3d::Identity()},
        rasterizer(camera.intrinsics) {
    pose.linear() = Eigen::AngleAxisd(2.2, Eigen::Vector3d::UnitX()).toRotationMatrix();
    pose.translation() = Eigen::Vector3d(0.0, 0.03, 0.8);
    aside = Eigen::Translation3d(0.003, 0.0, 0.002) * pose;
  }
  Observation observe() {
    const DepthPatch seen = rasterizer.render(mesh, pose);
    DepthImage image(640, 480);
    for (int v = seen.window.v0; v < seen.window.v1; ++v)
      for (int u = seen.window.u0; u < seen.window.u1; ++u)
        if (seen.at(u, v) < no_surface) image(u, v) = seen.at(u, v);
    return {camera, image, std::nullopt};
  }
};

void render(benchmark::State& state) {
  Bench bench;
  use_instruction_set(static_cast<InstructionSet>(state.range(0)));
  DepthPatch patch;
  for (auto _ : state) {
    bench.rasterizer.render(bench.mesh, bench.pose, patch);
    benchmark::DoNotOptimize(patch.depth.data());
  }
  use_instruction_set(InstructionSet::x86_64_v4);
}
BENCHMARK(render)->ArgName("instruction_set")->DenseRange(0, 2)->Unit(benchmark::kMicrosecond);

void render_samples(benchmark::State& state) {
  Bench bench;
  DepthPatch patch;
  DepthCrosses crosses;
  for (auto _ : state) {
    bench.rasterizer.render_samples(bench.mesh, bench.pose, 400, crosses, patch);
    benchmark::DoNotOptimize(crosses.depth.data());
  }
}
BENCHMARK(render_samples)->Unit(benchmark::kMicrosecond);

void render_plainly(benchmark::State& state) {
  Bench bench;
  Mesh placed = bench.mesh;
  for (Eigen::Vector3f& p : placed.vertices) p = bench.pose.cast<float>() * p;
  for (auto _ : state) {
    const DepthPatch patch = reference_drawing(placed, bench.camera.intrinsics);
    benchmark::DoNotOptimize(patch.depth.data());
  }
}
BENCHMARK(render_plainly)->Unit(benchmark::kMicrosecond);

void value_alone(benchmark::State& state) {
  Bench bench(static_cast<double>(state.range(0)));
  const Observation observation = bench.observe();
  const DeltaIndex index(observation, 0.005, SerialExecutor());
  const ExplanationCost cost(observation, index, MissingDepth::unexplained);
  const DepthPatch patch = bench.rasterizer.render(bench.mesh, bench.aside);
  LoneCost lone(cost);
  LoneValue value;
  for (auto _ : state) {
    lone.value(patch, value);
    benchmark::DoNotOptimize(value.explained_count);
  }
}
BENCHMARK(value_alone)->ArgName("focal")->Arg(525)->Arg(1067)->Unit(benchmark::kMicrosecond);

void value_in_general(benchmark::State& state) {
  Bench bench(static_cast<double>(state.range(0)));
  const Observation observation = bench.observe();
  const DeltaIndex index(observation, 0.005, SerialExecutor());
  const ExplanationCost cost(observation, index, MissingDepth::unexplained);
  const DepthPatch patch = bench.rasterizer.render(bench.mesh, bench.aside);
  const Composite nothing = cost.empty();
  CostChange change;
  for (auto _ : state) {
    cost.change(nothing, patch, change);
    benchmark::DoNotOptimize(change.gained.data());
  }
}
BENCHMARK(value_in_general)->ArgName("focal")->Arg(525)->Arg(1067)->Unit(benchmark::kMicrosecond);

void align_samples(benchmark::State& state) {
  Bench bench;
  const Observation observation = bench.observe();
  const NearestTable table(observation, 0.02, SerialExecutor());
  const RefineSettings settings;
  std::vector<SurfaceSample> samples;
  const DepthPatch patch = bench.rasterizer.render(bench.mesh, bench.aside);
  sample_patch(patch, nullptr, observation, settings, samples);
  for (auto _ : state)
    benchmark::DoNotOptimize(align(samples, {0.003, 0.0, 0.0}, false, table, 0.02, settings));
}
BENCHMARK(align_samples)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace perch
