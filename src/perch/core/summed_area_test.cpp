#include "perch/core/summed_area.hpp"

#include <gtest/gtest.h>

#include "perch/core/random.hpp"

namespace perch {
namespace {

/// Corners in random order: about a third of the windows are empty, and many reach outside.
Window random_window(Random& random) {
  const auto corner = [&] { return static_cast<int>(random.below(30)) - 10; };
  const int u0 = corner(), v0 = corner(), u1 = corner(), v1 = corner();
  return {u0, v0, u1, v1};
}

TEST(SummedArea, EqualsPlainSums) {
  int empty = 0, outside = 0, within = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Window window = seed % 2 == 0 ? random_window(random) : Window{-8, -9, 17, 18};
    Image<int> values(40, 40);  // pixel (u, v) at (u + 10, v + 10)
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<int>(random.below(2001)) - 1000;
    const SummedArea sums(window, [&](int u, int v) { return values(u + 10, v + 10); });
    for (int i = 0; i < 60; ++i) {
      const Window asked = random_window(random);
      std::int64_t expected = 0;
      for (int v = asked.v0; v < asked.v1; ++v)
        for (int u = asked.u0; u < asked.u1; ++u)
          if (window.contains(u, v)) expected += values(u + 10, v + 10);
      ASSERT_EQ(sums(asked), expected);
      const Window common = intersection(asked, window);
      empty += common.empty();
      within += !common.empty() && common == asked;
      outside += !common.empty() && common != asked;
    }
  }
  EXPECT_GT(empty, 100);
  EXPECT_GT(outside, 100);
  EXPECT_GT(within, 20);
}

TEST(SummedArea, OfNothingIsZero) {
  EXPECT_EQ(SummedArea()({-5, -5, 5, 5}), 0);
  EXPECT_EQ(SummedArea({3, 3, 3, 9}, [](int, int) { return 1; })({-5, -5, 15, 15}), 0);
}

// Sums of weights in fixed point don't fit 32 bits.
TEST(SummedArea, HoldsLargeSums) {
  constexpr std::int64_t large = std::int64_t{1} << 40;
  const SummedArea sums({0, 0, 64, 48}, [](int, int) { return large; });
  EXPECT_EQ(sums({0, 0, 64, 48}), 64 * 48 * large);
  EXPECT_EQ(sums({10, 20, 13, 25}), 15 * large);
}

}  // namespace
}  // namespace perch
