#include "perch/model/symmetry.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "perch/core/error.hpp"
#include "perch/core/random.hpp"

namespace perch {
namespace {

using std::numbers::pi;
constexpr int folds[] = {1, 2, 3, 4, 6, 7, 12, 360};

/// Angles anywhere, and those where a period ends.
double some_yaw(const Symmetry& symmetry, Random& random) {
  const double multiple = static_cast<double>(random.below(13)) - 6.0;
  switch (random.below(4)) {
    case 0:
      return multiple * symmetry.period();
    case 1:
      return std::nextafter(multiple * symmetry.period(), random.uniform(-1e9, 1e9));
    case 2:
      return multiple * pi / 2.0;
    default:
      return random.uniform(-20.0, 20.0);
  }
}

TEST(Symmetry, TakesTheSmallestDifferenceOverAllPeriods) {
  for (const int n : folds) {
    const Symmetry symmetry = Symmetry::n_fold(n);
    Random random(static_cast<std::uint64_t>(n));
    for (int trial = 0; trial < 300; ++trial) {
      const double a = some_yaw(symmetry, random), b = some_yaw(symmetry, random);
      double smallest = std::numeric_limits<double>::infinity();
      for (int k = -13 * n; k <= 13 * n; ++k)
        smallest = std::min(smallest, std::abs(a - b + k * 2.0 * pi / n));
      ASSERT_NEAR(symmetry.yaw_difference(a, b), smallest, 1e-12) << n << "-fold, " << a << ", " << b;
    }
  }
}

TEST(Symmetry, HasOneCanonicalYawForAllThatLookAlike) {
  for (const int n : folds) {
    const Symmetry symmetry = Symmetry::n_fold(n);
    Random random(static_cast<std::uint64_t>(n));
    for (int trial = 0; trial < 500; ++trial) {
      const double yaw = some_yaw(symmetry, random), canonical = symmetry.canonical_yaw(yaw);
      if (n == 1) {
        ASSERT_GT(canonical, -pi) << yaw;
        ASSERT_LE(canonical, pi) << yaw;
      } else {
        ASSERT_GE(canonical, 0.0) << n << "-fold, " << yaw;
        ASSERT_LT(canonical, symmetry.period()) << n << "-fold, " << yaw;
      }
      ASSERT_NEAR(symmetry.yaw_difference(yaw, canonical), 0.0, 1e-12) << n << "-fold, " << yaw;
      ASSERT_EQ(symmetry.canonical_yaw(canonical), canonical) << n << "-fold, " << yaw;
      // The other yaws of its kind have the same one, up to rounding across a period's end.
      const double alike = yaw + (static_cast<double>(random.below(9)) - 4.0) * symmetry.period();
      ASSERT_NEAR(symmetry.yaw_difference(symmetry.canonical_yaw(alike), canonical), 0.0, 1e-12)
          << n << "-fold, " << yaw;
    }
  }
}

TEST(Symmetry, SeesNoYawWhereContinuous) {
  const Symmetry symmetry = Symmetry::continuous();
  EXPECT_TRUE(symmetry.is_continuous());
  EXPECT_EQ(symmetry.canonical_yaw(1.23), 0.0);
  EXPECT_EQ(symmetry.yaw_difference(0.1, 2.9), 0.0);
}

TEST(Symmetry, RefusesWhatIsNoFold) {
  for (const int n : {-1, 0, 361, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()})
    EXPECT_THROW(Symmetry::n_fold(n), InvalidSetting) << n;
  EXPECT_NO_THROW(Symmetry::n_fold(1));
  EXPECT_NO_THROW(Symmetry::n_fold(360));
}

TEST(Symmetry, HasAName) {
  EXPECT_EQ(Symmetry::none().name(), "none");
  EXPECT_EQ(Symmetry::n_fold(1), Symmetry::none());
  EXPECT_EQ(Symmetry::n_fold(4).name(), "4");
  EXPECT_EQ(Symmetry::continuous().name(), "continuous");
}

}  // namespace
}  // namespace perch
