#include "perch/candidates/grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "perch/core/error.hpp"

namespace perch {
namespace {

using std::numbers::pi;

std::vector<Pose> poses(const PoseGrid& grid) {
  std::vector<Pose> all;
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(grid.size()); ++i) all.push_back(grid.pose(i));
  return all;
}

TEST(PoseGrid, CoversTheWorkspaceAtItsStep) {
  const Workspace workspace{-0.24, 0.24, -0.1, 0.17};
  const auto all = poses(PoseGrid(workspace, {}, Symmetry::none()));
  EXPECT_EQ(all.size(), 13U * 7U * 16U);
  std::set<double> xs, ys, yaws;
  for (const Pose& p : all) {
    xs.insert(p.x);
    ys.insert(p.y);
    yaws.insert(p.yaw);
  }
  EXPECT_EQ(xs.size() * ys.size() * yaws.size(), all.size());
  const auto steps_at_most = [](const std::set<double>& values, double low, double high, double step) {
    double last = low - step / 2;  // no point of the range is farther than half a step from a grid line
    for (const double v : values) {
      EXPECT_LE(v - last, step + 1e-9);
      EXPECT_GE(v, low - 1e-9);
      EXPECT_LE(v, high + 1e-9);
      last = v;
    }
    EXPECT_LE(high - last, step / 2 + 1e-9);
  };
  steps_at_most(xs, -0.24, 0.24, 0.04);
  steps_at_most(ys, -0.1, 0.17, 0.04);
}

// Fault: the yaw range of 180-degree-symmetric models is wrong.
TEST(PoseGrid, YawsCoverOnePeriodOfTheSymmetry) {
  const Workspace point{0, 0.001, 0, 0.001};
  for (const int n : {1, 2, 3, 4, 7, 90, 360}) {
    const Symmetry symmetry = Symmetry::n_fold(n);
    GridSettings settings;
    const auto all = poses(PoseGrid(point, settings, symmetry));
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_GE(all[i].yaw, 0.0);
      EXPECT_LT(all[i].yaw, 2 * pi / n - 1e-12);
      for (std::size_t j = 0; j < i; ++j) EXPECT_GT(symmetry.yaw_difference(all[i].yaw, all[j].yaw), 1e-6);
    }
    // Every yaw is within half a step of one on the grid, modulo the symmetry.
    for (double yaw = -7; yaw < 7; yaw += 0.01) {
      double nearest = 1e9;
      for (const Pose& p : all) nearest = std::min(nearest, symmetry.yaw_difference(yaw, p.yaw));
      ASSERT_LE(nearest, settings.yaw_resolution / 2 + 1e-9) << n;
    }
  }
  EXPECT_EQ(poses(PoseGrid(point, {}, Symmetry::n_fold(2))).size(), 8U);
  EXPECT_EQ(poses(PoseGrid(point, {}, Symmetry::continuous())).size(), 1U);
}

TEST(PoseGrid, SizeNeverOverflows) {
  GridSettings fine;
  fine.resolution = 1e-12;
  EXPECT_GT(PoseGrid({-1, 1, -1, 1}, fine, Symmetry::none()).size(), 1e24);
}

TEST(GridSettings, ChecksItsFields) {
  for (const double broken : std::initializer_list<double>{0.0, -0.04, std::nan(""), HUGE_VAL}) {
    GridSettings s;
    s.resolution = broken;
    EXPECT_THROW(s.check(), InvalidSetting);
    s = {};
    s.yaw_resolution = broken;
    EXPECT_THROW(s.check(), InvalidSetting);
  }
}

}  // namespace
}  // namespace perch
