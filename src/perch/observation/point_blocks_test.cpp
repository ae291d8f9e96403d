#include "perch/observation/point_blocks.hpp"

#include <gtest/gtest.h>

#include "perch/core/instruction_set.hpp"
#include "perch/core/random.hpp"

namespace perch {
namespace {

/// Slanting surfaces side by side with jumps in depth between them, and holes.
Observation random_observation(Random& random) {
  const int width = 1 + static_cast<int>(random.below(90)), height = 1 + static_cast<int>(random.below(70));
  const double f = random.uniform(20, 200);
  Camera camera;
  camera.intrinsics = {width, height, f, f * random.uniform(0.9, 1.1), 0.4 * width, 0.6 * height};
  DepthImage depth(width, height);
  const double near = random.uniform(0.3, 1.5), jump = random.uniform(0, 0.3), holes = random.uniform(0, 0.9);
  const double slope = random.uniform(-0.005, 0.005), noise = random.uniform(0, 0.004);
  const int step = 1 + static_cast<int>(random.below(20));
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      if (random.uniform() >= holes)
        depth(u, v) = static_cast<float>(
            std::max(0.05, near + jump * ((u / step + v / step) % 3) + slope * u + noise * random.normal()));
  depth(width / 2, height / 2) = 1.0F;
  return {camera, depth, std::nullopt};
}

/// The points of each block, by the only way to ask: a sum of sets.
struct Numbers {
  std::vector<std::size_t> of;
  Numbers& operator+=(const Numbers& other) {
    of.insert(of.end(), other.of.begin(), other.of.end());
    return *this;
  }
};

std::vector<Numbers> members(const PointBlocks& blocks, std::size_t points) {
  std::vector<Numbers> each(points);
  for (std::size_t i = 0; i < points; ++i) each[i].of = {i};
  return blocks.sums(each);
}

/// The number of the row whose points hold i.
int row_of(const Observation& observation, std::size_t i) {
  int v = 0;
  while (observation.row_begin(v + 1) <= i) ++v;
  return v;
}

TEST(PointBlocks, EveryPointLiesInTheBallOfItsBlock) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Observation observation = random_observation(random);
    const double radius = random.uniform(0.0005, 0.05);
    const PointBlocks blocks(observation, radius);
    const auto points_of = members(blocks, observation.size());
    ASSERT_EQ(points_of.size(), blocks.size());
    std::vector<int> met(observation.size(), 0);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      EXPECT_FALSE(points_of[b].of.empty());
      EXPECT_LE(static_cast<double>(blocks.radius()[b]), radius);
      const Eigen::Vector3d centre(blocks.x()[b], blocks.y()[b], blocks.z()[b]);
      for (const std::size_t i : points_of[b].of) {
        ++met[i];
        constexpr double rounding = 1e-6;
        ASSERT_LE((observation.points()[i].cast<double>() - centre).norm(),
                  static_cast<double>(blocks.radius()[b]) + rounding);
      }
    }
    EXPECT_EQ(met, std::vector<int>(observation.size(), 1));
    for (const auto* values : {&blocks.x(), &blocks.y(), &blocks.z(), &blocks.radius()})
      EXPECT_GE(values->size(), blocks.size() + lane_count) << "may be read a few at a time from any";
  }
}

// On a wall that the camera faces, without holes, each group of pixels is one block.
TEST(PointBlocks, AFlatGroupIsOneBlock) {
  Camera camera;
  camera.intrinsics = {50, 37, 100, 100, 25, 18};
  const Observation wall(camera, DepthImage(50, 37, 1.0F), std::nullopt);
  EXPECT_EQ(PointBlocks(wall, 0.0405).size(), 13U * 10U) << "4 x 4 pixels of 1 cm";
  EXPECT_EQ(PointBlocks(wall, 0.0999).size(), 6U * 5U) << "9 x 9 pixels";
  EXPECT_EQ(PointBlocks(wall, 0.001).size(), 50U * 37U);
}

TEST(PointBlocks, RangesHoldEveryBlockWithAPointInTheWindow) {
  std::size_t left_out = 0;
  for (std::uint64_t seed = 101; seed <= 140; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Observation observation = random_observation(random);
    const PointBlocks blocks(observation, random.uniform(0.0005, 0.05));
    const auto points_of = members(blocks, observation.size());
    for (int round = 0; round < 30; ++round) {
      const auto corner = [&] { return static_cast<int>(random.below(150)) - 30; };
      const Window window{corner(), corner(), corner(), corner()};
      std::vector<char> visited(blocks.size(), 0);
      std::size_t end = 0;
      blocks.for_each_range(window, [&](const PointBlocks::Range& range) {
        ASSERT_LE(end, range.first);
        ASSERT_LE(range.first, range.last);
        ASSERT_LE(range.last, blocks.size());
        end = range.last;
        std::fill(visited.begin() + static_cast<std::ptrdiff_t>(range.first),
                  visited.begin() + static_cast<std::ptrdiff_t>(range.last), 1);
      });
      for (std::size_t b = 0; b < blocks.size(); ++b) {
        for (const std::size_t i : points_of[b].of)
          if (window.contains(observation.column(i), row_of(observation, i))) {
            ASSERT_TRUE(visited[b]) << "block " << b;
          }
        left_out += !visited[b];
      }
    }
  }
  EXPECT_GT(left_out, 1000U);
}

TEST(PointBlocks, SumsAreThoseOfTheirPoints) {
  for (std::uint64_t seed = 201; seed <= 220; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Observation observation = random_observation(random);
    const PointBlocks blocks(observation, random.uniform(0.0005, 0.05));
    std::vector<std::int64_t> values(observation.size());
    for (std::int64_t& value : values) value = static_cast<std::int64_t>(random.below(1U << 20));
    const auto points_of = members(blocks, observation.size());
    const auto sums = blocks.sums(values);
    ASSERT_EQ(sums.size(), blocks.size());
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      std::int64_t expected = 0;
      for (const std::size_t i : points_of[b].of) expected += values[i];
      EXPECT_EQ(sums[b], expected);
    }
  }
}

}  // namespace
}  // namespace perch
