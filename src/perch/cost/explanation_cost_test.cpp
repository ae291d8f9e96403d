// Every count against brute force in O(n^2): all pairs of points, in float.

#include "perch/cost/explanation_cost.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "perch/core/random.hpp"
#include "perch/cost/random_scene_test_support.hpp"

namespace perch {
namespace {

struct BruteForce {
  CostCounts counts;
  std::int64_t points = 0;
};

constexpr int bayer[8][8] = {{0, 32, 8, 40, 2, 34, 10, 42},  {48, 16, 56, 24, 50, 18, 58, 26},
                             {12, 44, 4, 36, 14, 46, 6, 38}, {60, 28, 52, 20, 62, 30, 54, 22},
                             {3, 35, 11, 43, 1, 33, 9, 41},  {51, 19, 59, 27, 49, 17, 57, 25},
                             {15, 47, 7, 39, 13, 45, 5, 37}, {63, 31, 55, 23, 61, 29, 53, 21}};

/// Straight from the definition: R is the nearest surface of the patches, J counts points without a partner.
BruteForce brute_force(const Observation& observation, const DepthImage& depth,
                       const std::vector<DepthPatch>& patches, const CostSettings& settings) {
  const auto delta = static_cast<float>(settings.delta);
  const float delta_squared = delta * delta;
  std::vector<Eigen::Vector3f> rendered;
  for (int v = 0; v < observation.intrinsics().height; ++v)
    for (int u = 0; u < observation.intrinsics().width; ++u) {
      float nearest = no_surface;
      for (const DepthPatch& patch : patches) nearest = std::min(nearest, patch.at_or_none(u, v));
      if (!(nearest < no_surface)) continue;
      if (settings.missing_depth == MissingDepth::ignore && observation.state(u, v) == PixelState::unknown)
        continue;
      const bool hidden = depth(u, v) > 0.0F && nearest > depth(u, v) + delta;
      if (settings.clutter && hidden && bayer[v % 8][u % 8] >= std::lround(64.0 * settings.clutter_weight))
        continue;
      rendered.push_back(observation.rays().point(u, v, nearest));
    }
  const auto unexplained = [&](const auto& cloud, const auto& by) {
    std::int64_t count = 0;
    for (const auto& p : cloud) {
      bool found = false;
      for (const auto& q : by) {
        const float dx = p.x() - q.x(), dy = p.y() - q.y(), dz = p.z() - q.z();
        found = found || dx * dx + dy * dy + dz * dz <= delta_squared;
      }
      count += !found;
    }
    return count;
  };
  return {{settings.charges_points() ? unexplained(observation.points(), rendered) : 0,
           unexplained(rendered, observation.points())},
          static_cast<std::int64_t>(rendered.size())};
}

TEST(ExplanationCost, EqualsBruteForceOnRandomScenes) {
  const SerialExecutor executor;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const RandomScene scene = random_scene(seed);
    const Observation observation(scene.camera, scene.depth, scene.mask);
    const DeltaIndex index(observation, scene.delta, executor);
    for (const CostSettings& settings : cost_variants(scene.delta)) {
      const ExplanationCost cost(observation, index, settings);
      Composite composite = cost.empty();
      CostChange scratch;
      std::vector<DepthPatch> placed;
      for (const DepthPatch& patch : scene.patches) {
        placed.push_back(patch);
        const BruteForce expected = brute_force(observation, scene.depth, placed, settings);
        ASSERT_EQ(cost.counts_with(composite, patch, scratch), expected.counts);
        cost.add(composite, patch, scratch);
        ASSERT_EQ(cost.counts(composite), expected.counts);
        ASSERT_EQ(composite.points, expected.points);
        ASSERT_EQ(static_cast<std::int64_t>(composite.observed.count()), composite.observed_count);
      }
    }
  }
}

// Depths and delta with few bits: many pairs then lie at exactly delta, and rounding plays no part.
TEST(ExplanationCost, CountsPointsAtExactlyDelta) {
  const SerialExecutor executor;
  int at_delta = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    Camera camera;
    camera.intrinsics = {12, 9, 64, 64, 4, 4};  // slopes are multiples of 1/64
    const double delta = static_cast<double>(1 + random.below(3)) / 64.0;
    const auto depth = [&] { return static_cast<float>(1.0 + static_cast<double>(random.below(3)) / 64.0); };
    DepthImage image(12, 9);
    for (std::size_t i = 0; i < image.size(); ++i)
      if (random.uniform() < 0.4) image[i] = depth();
    image[0] = 1.0F;
    const Observation observation(camera, image, std::nullopt);
    DepthPatch patch{{0, 0, 12, 9}, {}};
    for (int i = 0; i < 12 * 9; ++i) patch.depth.push_back(random.uniform() < 0.3 ? depth() : no_surface);
    for (const auto& p : observation.points())
      for (int v = 0; v < 9; ++v)
        for (int u = 0; u < 12; ++u)
          if (patch.at(u, v) < no_surface)
            at_delta +=
                (p - observation.rays().point(u, v, patch.at(u, v))).norm() == static_cast<float>(delta);
    const DeltaIndex index(observation, delta, executor);
    const CostSettings settings{delta};
    const ExplanationCost cost(observation, index, settings);
    CostChange scratch;
    EXPECT_EQ(cost.counts_with(cost.empty(), patch, scratch),
              brute_force(observation, image, {patch}, settings).counts);
  }
  EXPECT_GT(at_delta, 1000);
}

TEST(ExplanationCost, TellsUnknownFromFree) {
  Camera camera;
  camera.intrinsics = {3, 1, 100, 100, 1, 0};
  DepthImage image(3, 1);
  image(0, 0) = 1.0F;  // an object's
  image(1, 0) = 1.5F;  // masked out: background
  Image<std::uint8_t> mask(3, 1, 1);
  mask(1, 0) = 0;  // (2, 0) has no reading
  const Observation observation(camera, image, mask);
  EXPECT_EQ(observation.state(0, 0), PixelState::object);
  EXPECT_EQ(observation.state(1, 0), PixelState::free);
  EXPECT_EQ(observation.state(2, 0), PixelState::unknown);
  const SerialExecutor executor;
  const DeltaIndex index(observation, 0.001, executor);
  const DepthPatch patch{{0, 0, 3, 1}, {1.0F, 1.0F, 1.0F}};
  CostChange scratch;
  const ExplanationCost formula(observation, index, {0.001});
  EXPECT_EQ(formula.counts_with(formula.empty(), patch, scratch), (CostCounts{0, 2}));
  const ExplanationCost ignore(observation, index, {0.001, MissingDepth::ignore});
  EXPECT_EQ(ignore.counts_with(ignore.empty(), patch, scratch), (CostCounts{0, 1}));
}

// The share of all pixels that charges for what clutter hides, by the published matrix.
TEST(ClutterPattern, IsBayersMatrix) {
  for (int v = 0; v < 16; ++v)
    for (int u = 0; u < 16; ++u)
      for (int n = 1; n <= 64; ++n)
        ASSERT_EQ(charged_by_clutter(u, v, n / 64.0), bayer[v % 8][u % 8] < n) << u << ' ' << v << ' ' << n;
}

TEST(DeltaIndex, ARangeIsUnexplainedOnlyIfEveryDepthInItIs) {
  const SerialExecutor executor;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const RandomScene scene = random_scene(seed);
    const Observation observation(scene.camera, scene.depth, scene.mask);
    const DeltaIndex index(observation, scene.delta, executor);
    Random random(seed + 1000);
    for (int i = 0; i < 50; ++i) {
      const int u = static_cast<int>(random.below(static_cast<std::uint64_t>(scene.depth.width())));
      const int v = static_cast<int>(random.below(static_cast<std::uint64_t>(scene.depth.height())));
      const float z = static_cast<float>(random.uniform(0.1, 1.8)),
                  reach = static_cast<float>(random.uniform(0, 0.1));
      if (!index.unexplained_throughout(u, v, z, reach)) continue;
      for (int k = 0; k <= 20; ++k) {
        const float depth = z - reach * static_cast<float>(k) / 20.0F;
        ASSERT_FALSE(depth > 0 && index.explained(u, v, depth));
      }
    }
  }
}

TEST(BallWindow, HoldsEveryPixelThatSeesTheBall) {
  const Intrinsics k{64, 48, 50, 55, 31.5, 20};
  const RaySlopes rays(k);
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    const double delta = random.uniform(0.001, 0.05);
    const Eigen::Vector3f p =
        rays.point(static_cast<int>(random.below(64)), static_cast<int>(random.below(48)),
                   static_cast<float>(random.uniform(0.02, 1.0)));
    const Window window = ball_window(k, p, delta);
    for (int v = 0; v < 48; ++v)
      for (int u = 0; u < 64; ++u) {
        const Eigen::Vector3d d(rays.x(u), rays.y(v), 1.0), c = p.cast<double>();
        const double along = std::max(0.0, d.dot(c) / d.squaredNorm());
        if ((along * d - c).norm() <= delta) {
          ASSERT_TRUE(window.contains(u, v)) << "point " << p.transpose() << " pixel " << u << ' ' << v;
        }
      }
  }
}

}  // namespace
}  // namespace perch
