// The blocks of I that hold what an object explains, beside the same question to every point of I.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "observed_mug.hpp"
#include "perch/candidates/explained_bound.hpp"
#include "perch/core/instruction_set.hpp"
#include "perch/cost/lone_cost.hpp"

namespace perch {
namespace {

constexpr double delta = 0.005;

struct Question {
  ObservedMug mug;
  ObjectModel model{"mug", mug.mesh, Symmetry::none(), 0.0, ExplainedBound::field_margin(delta)};
  DeltaIndex index{mug.observation, delta, SerialExecutor()};
  PointBlocks blocks{mug.observation, ExplainedBound::block_radius(delta)};
  ExplainedBound bound{mug.camera.intrinsics, blocks, delta, index.reach()};

  std::vector<Run> near_blocks() const { return bound.blocks(model, mug.aside); }

  /// The points that may lie within delta of the surface, or for certain: distances to it have an error.
  std::vector<Run> near_points(bool certain) const {
    const SolidVolume& solid = model.solid();
    const float error = 0.5F * solid.uncertainty();
    const float limit = static_cast<float>(delta) + (certain ? -error : error);
    const Eigen::Isometry3f model_from_camera = mug.aside.inverse().cast<float>();
    std::vector<Run> near;
    const auto& points = mug.observation.points();
    for (std::size_t i = 0; i < points.size(); ++i)
      if (std::abs(solid.signed_distance(model_from_camera * points[i])) <= limit)
        append(near, static_cast<std::uint32_t>(i));
    return near;
  }

  std::vector<Run> explained() const {
    const ExplanationCost cost(mug.observation, index, CostSettings{});
    LoneValue value;
    LoneCost(cost).value(mug.rendered, value);
    return value.explained;
  }

  /// True where the blocks hold all the points, and there are some.
  bool hold(const std::vector<Run>& near, const std::vector<Run>& points) const {
    std::vector<int> one(mug.observation.size(), 0);
    for (const Run& run : points) std::fill(one.begin() + run.first, one.begin() + run.last, 1);
    const std::vector<int> of_block = blocks.sums(one);
    int held = 0;
    for (const Run& run : near)
      held = std::accumulate(of_block.begin() + run.first, of_block.begin() + run.last, held);
    return held > 0 && held == std::accumulate(one.begin(), one.end(), 0);
  }
};

void ask_blocks(benchmark::State& state, InstructionSet set) {
  const Question question;
  use_instruction_set(set);
  const std::vector<Run> near = question.near_blocks();
  if (!question.hold(near, question.near_points(true)) || !question.hold(near, question.explained()))
    state.SkipWithError("the blocks don't hold all that is explained");
  for (auto _ : state) benchmark::DoNotOptimize(question.near_blocks());
  use_instruction_set(InstructionSet::x86_64_v4);
}
BENCHMARK_CAPTURE(ask_blocks, , InstructionSet::x86_64_v4)
    ->Name("near_blocks/kernel")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ask_blocks, , InstructionSet::baseline)
    ->Name("near_blocks/x86-64")
    ->Unit(benchmark::kMicrosecond);

void ask_points(benchmark::State& state) {
  const Question question;
  for (auto _ : state) benchmark::DoNotOptimize(question.near_points(false));
}
BENCHMARK(ask_points)->Name("near_blocks/every point")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace perch
