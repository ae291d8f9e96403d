#include "perch/verify/kd_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "perch/core/random.hpp"

namespace perch {
namespace {

/// Points with many equal coordinates, and some equal points.
std::vector<Eigen::Vector3d> random_points(Random& random, std::size_t n) {
  const auto coordinate = [&] {
    const double x = random.uniform(-1.0, 1.0);
    return random.uniform() < 0.5 ? x : std::round(4.0 * x) / 4.0;
  };
  std::vector<Eigen::Vector3d> points(n);
  for (Eigen::Vector3d& p : points) p = {coordinate(), coordinate(), coordinate()};
  return points;
}

TEST(KdTree, AnswersAsBruteForce) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto points = random_points(random, random.below(200));
    const KdTree tree(points);
    EXPECT_EQ(tree.size(), points.size());
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d p = random_points(random, 1).front();
      const double radius = random.uniform(0.0, 1.0);
      double nearest = std::numeric_limits<double>::infinity();
      std::set<std::size_t> within;
      for (std::size_t k = 0; k < points.size(); ++k) {
        nearest = std::min(nearest, (points[k] - p).norm());
        if ((points[k] - p).norm() <= radius) within.insert(k);
      }
      EXPECT_EQ(tree.nearest_distance(p), nearest);
      std::multiset<std::size_t> visited;
      EXPECT_FALSE(tree.any_within(p, radius, [&](std::size_t k) {
        visited.insert(k);
        return false;
      }));
      EXPECT_EQ(visited, std::multiset<std::size_t>(within.begin(), within.end()));
      if (within.empty()) continue;
      const std::size_t wanted = *within.rbegin();
      EXPECT_TRUE(tree.any_within(p, radius, [&](std::size_t k) { return k == wanted; }));
    }
  }
}

TEST(KdTree, PointsAllAtOnePlace) {
  const KdTree tree(std::vector<Eigen::Vector3d>(1000, Eigen::Vector3d(1, 2, 3)));
  EXPECT_EQ(tree.nearest_distance({1, 2, 5}), 2.0);
  std::size_t visited = 0;
  EXPECT_FALSE(tree.any_within({1, 2, 3}, 0.0, [&](std::size_t) { return ++visited == 1001; }));
  EXPECT_EQ(visited, 1000U);
}

TEST(KdTree, EmptyHasNothingNear) {
  EXPECT_EQ(KdTree({}).nearest_distance({0, 0, 0}), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace perch
