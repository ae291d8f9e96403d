#include "perch/core/assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

#include "perch/core/random.hpp"

namespace perch {
namespace {

/// The least sum over all ways to give the rows different columns; no more rows than columns.
double least_by_brute_force(const Eigen::MatrixXd& costs) {
  std::vector<Eigen::Index> columns(static_cast<std::size_t>(costs.cols()));
  std::iota(columns.begin(), columns.end(), 0);
  double least = std::numeric_limits<double>::infinity();
  do {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < costs.rows(); ++i) sum += costs(i, columns[static_cast<std::size_t>(i)]);
    least = std::min(least, sum);
  } while (std::next_permutation(columns.begin(), columns.end()));
  return least;
}

TEST(Assignment, CostsWhatTheBestOfAllPermutationsDoes) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const auto rows = static_cast<Eigen::Index>(1 + random.below(6));
    const auto columns = static_cast<Eigen::Index>(1 + random.below(6));
    Eigen::MatrixXd costs(rows, columns);
    // Whole numbers of a small range every other time, so that many assignments cost the same.
    for (double& cost : costs.reshaped())
      cost = seed % 2 == 0 ? random.uniform(-1.0, 1.0) : static_cast<double>(random.below(4));
    const auto found = min_cost_assignment(costs);
    ASSERT_EQ(found.size(), static_cast<std::size_t>(rows));
    std::set<std::size_t> used;
    double sum = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!found[i]) continue;
      EXPECT_TRUE(used.insert(*found[i]).second) << "column " << *found[i] << " is given twice";
      sum += costs(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(*found[i]));
    }
    EXPECT_EQ(used.size(), static_cast<std::size_t>(std::min(rows, columns)));
    const double least = least_by_brute_force(rows <= columns ? costs : Eigen::MatrixXd(costs.transpose()));
    EXPECT_NEAR(sum, least, 1e-12);
  }
}

TEST(Assignment, OfNothingIsNothing) {
  EXPECT_TRUE(min_cost_assignment(Eigen::MatrixXd(0, 3)).empty());
  EXPECT_EQ(min_cost_assignment(Eigen::MatrixXd(2, 0)),
            (std::vector<std::optional<std::size_t>>{std::nullopt, std::nullopt}));
}

}  // namespace
}  // namespace perch
