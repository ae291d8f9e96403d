#include "perch/tree/monotone.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numeric>

#include "perch/core/error.hpp"
#include "perch/core/random.hpp"

namespace perch {
namespace {

struct View {
  Camera camera;
  SerialExecutor executor;
  std::unique_ptr<Observation> observation;
  std::unique_ptr<DeltaIndex> index;
  std::unique_ptr<ExplanationCost> cost;

  View() {
    camera.intrinsics = {24, 18, 30, 30, 12, 9};
    observation = std::make_unique<Observation>(camera, DepthImage(24, 18, 1.0F), std::nullopt);
    index = std::make_unique<DeltaIndex>(*observation, 0.01, executor);
    cost = std::make_unique<ExplanationCost>(*observation, *index, CostSettings{});
  }
};

DepthPatch flat(const Window& window, float z) {
  return {window, std::vector<float>(static_cast<std::size_t>(window.width() * window.height()), z)};
}

// Fault: one pixel of depth noise breaks monotonicity.
TEST(Monotone, ToleratesSensorSizedDifferences) {
  const View view;
  const DepthPatch parent = flat({2, 2, 12, 12}, 1.0F);
  DepthPatch child = flat({8, 2, 20, 12}, 1.2F);
  EXPECT_TRUE(keeps_monotone(*view.cost, parent, child, {0.0, 0}));
  child.depth[0] = 0.998F;  // one pixel, two millimetres
  EXPECT_FALSE(keeps_monotone(*view.cost, parent, child, {0.0, 0})) << "the strict condition breaks";
  EXPECT_TRUE(keeps_monotone(*view.cost, parent, child, {0.005, 0})) << "within the depth";
  child.depth[0] = 0.5F;
  EXPECT_FALSE(keeps_monotone(*view.cost, parent, child, {0.005, 0}));
  EXPECT_TRUE(keeps_monotone(*view.cost, parent, child, {0.005, 1})) << "or within the number of pixels";
  EXPECT_FALSE(keeps_monotone(*view.cost, parent, flat({8, 2, 20, 12}, 0.8F), {0.005, 30}))
      << "an occluder is one";
}

TEST(Monotone, OrderExistsAsByTryingAllPermutations) {
  const View view;
  int monotone = 0, others = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const MonotoneSettings settings{random.uniform() < 0.5 ? 0.0 : 0.02, static_cast<int>(random.below(3))};
    std::vector<DepthPatch> patches;
    const bool many = seed % 2 == 0;  // small ones in several groups of what hides what
    const std::size_t n = many ? 4 + random.below(3) : 2 + random.below(3);
    for (std::size_t i = 0; i < n; ++i) {
      const int u = static_cast<int>(random.below(10)), v = static_cast<int>(random.below(8));
      DepthPatch patch = flat({u, v, u + 2 + static_cast<int>(random.below(many ? 4 : 6)),
                               v + 2 + static_cast<int>(random.below(many ? 3 : 5))},
                              1.0F);
      // Slanted, so that patches pass through each other and hide one another mutually.
      const double slope = random.uniform(-0.3, 0.3);
      for (std::size_t k = 0; k < patch.depth.size(); ++k)
        patch.depth[k] = static_cast<float>(
            1.0 + slope * static_cast<double>(k % static_cast<std::size_t>(patch.window.width())) +
            random.uniform(0, 0.03));
      patches.push_back(std::move(patch));
    }
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    bool expected = false;
    do {
      DepthPatch composite;
      bool holds = true;
      for (const std::size_t i : order) {
        holds = holds && keeps_monotone(*view.cost, composite, patches[i], settings);
        composite = compose({&composite, &patches[i]});
      }
      expected = expected || holds;
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_EQ(monotone_order_exists(*view.cost, patches, settings), expected);
    ++(expected ? monotone : others);
  }
  EXPECT_GT(monotone, 50);
  EXPECT_GT(others, 30);
}

// Two pairs: 0 apart, 1 and 2 hide one another; 3 touches 0 and 1 and so joins what they belong to.
TEST(Monotone, AnObjectThatJoinsTwoGroupsLeavesNoneOut) {
  const View view;
  std::vector<DepthPatch> patches{flat({0, 0, 4, 4}, 1.0F), flat({8, 0, 14, 4}, 1.0F),
                                  flat({12, 0, 18, 4}, 1.0F), flat({2, 0, 10, 4}, 0.5F)};
  EXPECT_TRUE(monotone_order_exists(*view.cost, patches, {0.0, 0}));
  for (int u = 12; u < 14; ++u) {
    patches[2].depth[patches[2].index(u, 0)] = 0.9F;
    patches[2].depth[patches[2].index(u, 3)] = 1.1F;
  }
  EXPECT_FALSE(monotone_order_exists(*view.cost, patches, {0.0, 0}));
}

TEST(Monotone, ChecksItsSettings) {
  EXPECT_THROW((MonotoneSettings{-1.0, 0}.check()), InvalidSetting);
  EXPECT_THROW((MonotoneSettings{0.0, -1}.check()), InvalidSetting);
  EXPECT_NO_THROW(MonotoneSettings{}.check());
}

}  // namespace
}  // namespace perch
