#include "perch/render/depth_patch.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "perch/core/random.hpp"

namespace perch {
namespace {

DepthPatch random_patch(Random& random) {
  const int u0 = static_cast<int>(random.below(20)), v0 = static_cast<int>(random.below(12));
  DepthPatch patch;
  patch.window = {u0, v0, u0 + 1 + static_cast<int>(random.below(9)),
                  v0 + 1 + static_cast<int>(random.below(7))};
  for (int i = 0; i < patch.window.width() * patch.window.height(); ++i)
    patch.depth.push_back(random.uniform() < 0.3 ? no_surface : static_cast<float>(random.uniform(0.1, 2.0)));
  return patch;
}

TEST(Compose, TakesTheNearestOfAll) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    std::vector<DepthPatch> patches;
    for (std::uint64_t n = 1 + random.below(5); n > 0; --n) patches.push_back(random_patch(random));
    patches.emplace_back();  // an object out of view
    std::vector<const DepthPatch*> pointers;
    for (const DepthPatch& patch : patches) pointers.push_back(&patch);

    const DepthPatch composite = compose(pointers);
    Window window;
    std::size_t covered = 0;
    for (int v = -1; v < 25; ++v)
      for (int u = -1; u < 35; ++u) {
        float nearest = no_surface;
        bool held = false;
        for (const DepthPatch& patch : patches) {
          nearest = std::min(nearest, patch.at_or_none(u, v));
          held = held || patch.window.contains(u, v);
        }
        covered += nearest < no_surface;
        if (held) window = bounding(window, {u, v, u + 1, v + 1});
        ASSERT_EQ(composite.at_or_none(u, v), nearest) << "seed " << seed << ", pixel " << u << ", " << v;
      }
    EXPECT_EQ(composite.window, window) << "seed " << seed;
    EXPECT_EQ(composite.covered(), covered) << "seed " << seed;
  }
}

TEST(Compose, OfNothingIsEmpty) {
  EXPECT_TRUE(compose({}).window.empty());
  const DepthPatch none;
  const DepthPatch composite = compose({&none, &none});
  EXPECT_TRUE(composite.window.empty());
  EXPECT_TRUE(composite.depth.empty());
  EXPECT_EQ(composite.covered(), 0U);
  EXPECT_EQ(composite.at_or_none(0, 0), no_surface);
}

}  // namespace
}  // namespace perch
