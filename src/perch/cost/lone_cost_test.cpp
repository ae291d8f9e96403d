// The fast valuation of a lone object against the general one, on every instruction set of this processor.

#include "perch/cost/lone_cost.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "perch/core/instruction_set.hpp"
#include "perch/cost/random_scene_test_support.hpp"

namespace perch {
namespace {

std::vector<std::uint32_t> numbers(const std::vector<Run>& runs) {
  std::vector<std::uint32_t> all;
  for (const Run& run : runs) {
    EXPECT_LT(run.first, run.last);
    for (std::uint32_t i = run.first; i < run.last; ++i) all.push_back(i);
  }
  return all;
}

class LoneCostTest : public testing::Test {
 protected:
  void TearDown() override { use_instruction_set(InstructionSet::x86_64_v4); }

  /// Returns how many points of I the patches explain.
  static std::size_t compare(const RandomScene& scene, const CostSettings& settings) {
    const SerialExecutor executor;
    const Observation observation(scene.camera, scene.depth, scene.mask);
    const DeltaIndex index(observation, scene.delta, executor);
    const ExplanationCost cost(observation, index, settings);
    std::size_t explained = 0;
    for (const DepthPatch& patch : scene.patches) {
      CostChange change;
      cost.change(cost.empty(), patch, change);
      std::int64_t exposed = 0;
      std::vector<std::uint32_t> certain, uncertain, shown;
      for (int v = patch.window.v0; v < patch.window.v1; ++v)
        for (int u = patch.window.u0; u < patch.window.u1; ++u) {
          const float z = patch.at(u, v), seen = observation.depth(u, v);
          if (!(z < no_surface) || !cost.counts_at(u, v, z)) continue;
          const auto pixel = static_cast<std::uint32_t>(v * observation.intrinsics().width + u);
          if (change.appears.contains(u, v)) {
            shown.push_back(pixel);
            continue;
          }
          exposed +=
              !settings.charges_points() || !(seen > 0.0F && seen < z - static_cast<float>(scene.delta));
          (index.unexplained_throughout(u, v, z, z) ? certain : uncertain).push_back(pixel);
        }
      for (const InstructionSet set :
           {InstructionSet::baseline, InstructionSet::x86_64_v3, InstructionSet::x86_64_v4}) {
        use_instruction_set(set);
        LoneCost lone(cost);
        LoneValue value;
        lone.value(scene.patches.back(), value);  // leaves something in the scratch memory
        lone.value(patch, value);
        EXPECT_EQ(value.points, change.points);
        EXPECT_EQ(value.unexplained, change.unexplained);
        EXPECT_EQ(value.exposed, exposed);
        EXPECT_EQ(value.explained_count, static_cast<std::int64_t>(change.gained.size()));
        EXPECT_EQ(numbers(value.explained), change.gained);
        EXPECT_EQ(numbers(value.certain), certain);
        EXPECT_EQ(numbers(value.uncertain), uncertain);
        EXPECT_EQ(numbers(value.shown), shown);
        const PointSet set_of(value.explained);
        EXPECT_EQ(set_of.count(), change.gained.size());
        for (const std::uint32_t i : change.gained) EXPECT_TRUE(set_of.contains(i));
      }
      explained += change.gained.size();
    }
    return explained;
  }
};

TEST_F(LoneCostTest, CountsBesideOthersAsTheGeneralCost) {
  std::int64_t hidden = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const RandomScene scene = random_scene(seed, 4);
    const SerialExecutor executor;
    const Observation observation(scene.camera, scene.depth, scene.mask);
    const DeltaIndex index(observation, scene.delta, executor);
    for (const CostSettings& settings : cost_variants(scene.delta)) {
      const ExplanationCost cost(observation, index, settings);
      Composite composite = cost.empty();
      CostChange scratch;
      for (const DepthPatch& patch : scene.patches) {
        const CostCounts expected = cost.counts_with(composite, patch, scratch);
        hidden += static_cast<std::int64_t>(scratch.lost.size());
        for (const InstructionSet set :
             {InstructionSet::baseline, InstructionSet::x86_64_v3, InstructionSet::x86_64_v4}) {
          use_instruction_set(set);
          LoneCost lone(cost);
          EXPECT_EQ(lone.counts_with(composite, patch, std::numeric_limits<std::int64_t>::max()), expected);
          EXPECT_EQ(lone.counts_with(composite, patch, expected.total()), expected);
          EXPECT_FALSE(lone.counts_with(composite, patch, expected.total() - 1));
        }
        Composite after = composite;
        cost.add(after, patch, scratch);
        for (const InstructionSet set :
             {InstructionSet::baseline, InstructionSet::x86_64_v3, InstructionSet::x86_64_v4}) {
          use_instruction_set(set);
          Composite same = composite;
          LoneCost(cost).add(same, patch);
          EXPECT_EQ(same.depth.window, after.depth.window);
          EXPECT_EQ(same.depth.depth, after.depth.depth);
          EXPECT_EQ(same.explained, after.explained);
          EXPECT_EQ(same.observed_count, after.observed_count);
          EXPECT_EQ(same.observed.count(), after.observed.count());
          EXPECT_EQ(same.observed.count_not_in(after.observed), 0U);
          EXPECT_EQ(same.points, after.points);
          EXPECT_EQ(same.unexplained, after.unexplained);
        }
        composite = std::move(after);
      }
    }
    ASSERT_FALSE(testing::Test::HasFailure());
  }
  EXPECT_GT(hidden, 300);
}

TEST_F(LoneCostTest, EqualsTheGeneralCount) {
  std::size_t explained = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    for (const int size : seed <= 60 ? std::vector{1, 4} : std::vector{1}) {
      const RandomScene scene = random_scene(seed, size);
      for (const CostSettings& settings : cost_variants(scene.delta)) explained += compare(scene, settings);
    }
    ASSERT_FALSE(testing::Test::HasFailure());
  }
  EXPECT_GT(explained, 10000U);
}

}  // namespace
}  // namespace perch
