#include "perch/model/distance_transform.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "perch/core/instruction_set.hpp"
#include "perch/core/random.hpp"

namespace perch {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

std::vector<float> brute_force(const std::vector<float>& grid, const Eigen::Vector3i& size) {
  const auto voxel = [&](std::size_t i) {
    const int n = static_cast<int>(i);
    return Eigen::Vector3i(n % size.x(), n / size.x() % size.y(), n / (size.x() * size.y()));
  };
  std::vector<float> distances(grid.size(), infinity);
  for (std::size_t j = 0; j < grid.size(); ++j)
    if (grid[j] == 0.0F)
      for (std::size_t i = 0; i < grid.size(); ++i)
        distances[i] = std::min(distances[i], static_cast<float>((voxel(i) - voxel(j)).squaredNorm()));
  return distances;
}

TEST(DistanceTransform, EqualsBruteForce) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const auto side = [&] { return 1 + static_cast<int>(random.below(11)); };
    const Eigen::Vector3i size(side(), side(), side());
    const double share = seed % 3 == 0 ? 0.005 : random.uniform();  // often one zero or none
    std::vector<float> grid(static_cast<std::size_t>(size.prod()));
    for (float& value : grid) value = random.uniform() < share ? 0.0F : infinity;
    const std::vector<float> expected = brute_force(grid, size);
    squared_distance_transform(grid, size, SerialExecutor());
    ASSERT_EQ(grid, expected) << "seed " << seed << ", size " << size.transpose();
  }
}

/// Grids wider than what is worked on together, for every instruction set and any executor.
TEST(DistanceTransform, EqualsBruteForceOnWideGrids) {
  const ThreadExecutor three(3);
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Random random(seed);
    const auto side = [&] { return 1 + static_cast<int>(random.below(50)); };
    const Eigen::Vector3i size(side(), side(), side());
    std::vector<float> grid(static_cast<std::size_t>(size.prod()), infinity);
    for (std::size_t n = random.below(seed % 2 == 0 ? 4 : 60); n > 0; --n)
      grid[random.below(grid.size())] = 0.0F;
    const std::vector<float> expected = brute_force(grid, size);
    for (const InstructionSet set :
         {InstructionSet::baseline, InstructionSet::x86_64_v3, InstructionSet::x86_64_v4}) {
      use_instruction_set(set);
      std::vector<float> serial = grid, shared = grid;
      squared_distance_transform(serial, size, SerialExecutor());
      squared_distance_transform(shared, size, three);
      ASSERT_EQ(serial, expected) << "seed " << seed << ", size " << size.transpose();
      ASSERT_EQ(shared, expected) << "seed " << seed << ", size " << size.transpose();
    }
  }
}

TEST(DistanceTransform, IsInfiniteWhereNothingIsZero) {
  std::vector<float> grid(5 * 4 * 3, infinity);
  squared_distance_transform(grid, {5, 4, 3}, SerialExecutor());
  EXPECT_EQ(grid, std::vector<float>(5 * 4 * 3, infinity));
}

TEST(DistanceTransform, IsExactOnALongLine) {
  std::vector<float> grid(1000, infinity);
  grid[0] = grid[700] = 0.0F;
  squared_distance_transform(grid, {1, 1, 1000}, SerialExecutor());
  for (int i = 0; i < 1000; ++i) {
    const float d = static_cast<float>(std::min(i, std::abs(i - 700)));
    ASSERT_EQ(grid[static_cast<std::size_t>(i)], d * d) << i;
  }
}

}  // namespace
}  // namespace perch
