#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "perch/core/random.hpp"
#include "perch/eval/pose_errors.hpp"
#include "perch/eval/surface_discrepancy.hpp"
#include "perch/eval/test_shapes.hpp"
#include "perch/eval/visible_fractions.hpp"

// Each metric against a closed form, a brute-force search or pixels counted by hand.
namespace perch {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

Eigen::Isometry3d moved(double x, double y, double z, double yaw = 0.0) {
  return Eigen::Translation3d(x, y, z) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
}

std::vector<Eigen::Vector3f> cloud(Random& random, int n) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < n; ++i)
    points.emplace_back(0.1 *
                        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).cast<float>());
  return points;
}

Eigen::Isometry3d any_pose(Random& random) {
  const Eigen::Quaterniond turn(random.normal(), random.normal(), random.normal(), random.normal());
  return Eigen::Translation3d(random.normal(), random.normal(), random.normal()) * turn.normalized();
}

// --- Diameter, ADD, ADD-S
// -------------------------------------------------------------------------------------

TEST(Diameter, IsTheLongestDiagonalOfABox) {
  EXPECT_NEAR(diameter(testing_eval::box(0.3F, 0.4F, 1.2F).vertices), 1.3, 1e-7);
  EXPECT_EQ(diameter(std::vector<Eigen::Vector3f>{{1.0F, 2.0F, 3.0F}}), 0.0);
}

TEST(Diameter, IsThatOfAllPairs) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto points = cloud(random, 1 + static_cast<int>(random.below(40)));
    double largest = 0.0;
    for (const auto& a : points)
      for (const auto& b : points) largest = std::max(largest, (a.cast<double>() - b.cast<double>()).norm());
    EXPECT_DOUBLE_EQ(diameter(points), largest);
  }
}

TEST(AverageDistance, OfAShiftIsItsLength) {
  const Mesh cube = testing_eval::box(0.1F, 0.1F, 0.1F);
  Random random(1);
  const Eigen::Isometry3d truth = any_pose(random);
  const Eigen::Isometry3d estimate = Eigen::Translation3d(0.03, -0.04, 0.12) * truth;
  EXPECT_NEAR(average_distance(cube.vertices, estimate, truth), 0.13, 1e-12);
  EXPECT_NEAR(average_distance(cube.vertices, truth, truth), 0.0, 1e-15);
}

TEST(AverageDistance, OfATurnIsTheMeanChord) {
  // All vertices of a square block lie at the same distance r from the axis: chords of 2 r sin(angle / 2).
  const Mesh block = testing_eval::box(0.2F, 0.2F, 0.5F);
  const double r = std::sqrt(0.02), angle = 0.7;
  EXPECT_NEAR(average_distance(block.vertices, moved(1, 2, 3, angle), moved(1, 2, 3)),
              2.0 * r * std::sin(angle / 2.0), 1e-8);
}

TEST(AverageNearestDistance, SeesNoQuarterTurnOfASquareBlock) {
  const Mesh block = testing_eval::box(0.2F, 0.2F, 0.5F);
  const Eigen::Isometry3d quarter = moved(0.1, 0, 0, std::numbers::pi / 2.0);
  EXPECT_NEAR(average_nearest_distance(block.vertices, quarter, moved(0.1, 0, 0)), 0.0, 1e-8);
  EXPECT_NEAR(average_distance(block.vertices, quarter, moved(0.1, 0, 0)), 0.2, 1e-8);
}

// From the truth to the estimate: with one outlier, the other direction gives another mean.
TEST(AverageNearestDistance, IsThatOfEveryPairFromTruthToEstimate) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    auto points = cloud(random, 1 + static_cast<int>(random.below(60)));
    points.emplace_back(2.0F, 0.0F, 0.0F);
    const Eigen::Isometry3d estimate = any_pose(random), truth = any_pose(random);
    double sum = 0.0;
    for (const auto& a : points) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& b : points)
        nearest = std::min(nearest, (truth * a.cast<double>() - estimate * b.cast<double>()).norm());
      sum += nearest;
    }
    EXPECT_NEAR(average_nearest_distance(points, estimate, truth), sum / static_cast<double>(points.size()),
                1e-9);
  }
}

// --- MSSD, MSPD
// -----------------------------------------------------------------------------------------------

double mssd(const Mesh& mesh, const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth,
            const Symmetry& symmetry) {
  return largest_surface_distance(mesh.vertices, estimate, truth, symmetry_turns(symmetry));
}

TEST(LargestSurfaceDistance, OfAShiftIsItsLength) {
  const Mesh cube = testing_eval::box(0.1F, 0.1F, 0.1F);
  for (const Symmetry& symmetry : {Symmetry::none(), Symmetry::n_fold(4)})
    EXPECT_NEAR(mssd(cube, moved(0.003, 0.004, 0.012), moved(0, 0, 0), symmetry), 0.013, 1e-8);
}

TEST(LargestSurfaceDistance, OfATurnIsTheLongestChordModuloTheSymmetry) {
  const Mesh plank = testing_eval::box(0.6F, 0.2F, 0.1F);
  const double r = std::sqrt(0.3 * 0.3 + 0.1 * 0.1);
  const auto chord = [&](double angle) { return 2.0 * r * std::sin(std::abs(angle) / 2.0); };
  const double turn = std::numbers::pi - 0.2;
  EXPECT_NEAR(mssd(plank, moved(1, 1, 0, turn), moved(1, 1, 0), Symmetry::none()), chord(turn), 1e-7);
  EXPECT_NEAR(mssd(plank, moved(1, 1, 0, turn), moved(1, 1, 0), Symmetry::n_fold(2)), chord(0.2), 1e-7);
  // At most half a step of 2 pi / 315 away.
  EXPECT_LE(mssd(plank, moved(1, 1, 0, 2.0), moved(1, 1, 0), Symmetry::continuous()),
            chord(std::numbers::pi / 315.0) + 1e-9);
}

TEST(SymmetryTurns, AreAsManyAsBopTakes) {
  EXPECT_EQ(symmetry_turns(Symmetry::none()).size(), 1U);
  EXPECT_EQ(symmetry_turns(Symmetry::n_fold(6)).size(), 6U);
  const auto turns = symmetry_turns(Symmetry::continuous());
  EXPECT_EQ(turns.size(), 315U);
  // The farthest vertex lies half a diameter from the axis at most, and travels by 1 % of it.
  EXPECT_LE(0.5 * 2.0 * std::numbers::pi / static_cast<double>(turns.size()), 0.01);
  EXPECT_TRUE(turns.front().isApprox(Eigen::Isometry3d::Identity()));
}

TEST(LargestProjectionDistance, OfAShiftAcrossTheViewIsThatOfTheNearestVertices) {
  const Intrinsics camera{640, 480, 500.0, 400.0, 320.0, 240.0};
  const Mesh cube = testing_eval::box(0.1F, 0.1F, 0.2F);  // depths 0.8 and 1.0
  const auto none = symmetry_turns(Symmetry::none());
  EXPECT_NEAR(
      largest_projection_distance(cube.vertices, moved(0.03, 0.04, 0.8), moved(0, 0, 0.8), none, camera),
      std::hypot(500.0 * 0.03, 400.0 * 0.04) / 0.8, 1e-5);
  EXPECT_NEAR(largest_projection_distance(cube.vertices, moved(0, 0, 0.8, std::numbers::pi), moved(0, 0, 0.8),
                                          symmetry_turns(Symmetry::n_fold(2)), camera),
              0.0, 1e-5);
}

TEST(LargestProjectionDistance, IsInfiniteWhereTheObjectIsNotInFrontOfTheCamera) {
  const Intrinsics camera{640, 480, 500.0, 400.0, 320.0, 240.0};
  const Mesh cube = testing_eval::box(0.1F, 0.1F, 0.2F);
  const auto none = symmetry_turns(Symmetry::none());
  for (const double z : {-5.0, -0.1, 0.0}) {
    EXPECT_EQ(largest_projection_distance(cube.vertices, moved(0, 0, z), moved(0, 0, 1), none, camera),
              INFINITY);
    EXPECT_EQ(largest_projection_distance(cube.vertices, moved(0, 0, 1), moved(0, 0, z), none, camera),
              INFINITY);
  }
}

// --- VSD
// ------------------------------------------------------------------------------------------------------

/// On the optical axis of a camera with long focal length, where distance and depth are the same.
const Intrinsics far_camera{8, 1, 1e9, 1e9, 4.0, 0.0};

/// Depths from column `u0` on; 0 for no surface.
DepthPatch strip(int u0, const std::vector<float>& depths) {
  DepthPatch patch{{u0, 0, u0 + static_cast<int>(depths.size()), 1}, depths};
  for (float& depth : patch.depth)
    if (depth == 0.0F) depth = no_surface;
  return patch;
}

std::array<double, tolerance_count> vsd(const DepthPatch& estimate, const DepthPatch& truth,
                                        const std::vector<float>& readings) {
  DepthImage observed(8, 1);
  for (std::size_t i = 0; i < readings.size(); ++i) observed[i] = readings[i];
  return surface_discrepancy(estimate, truth, observed, RaySlopes(far_camera), 0.1);
}

TEST(SurfaceDiscrepancy, IsNothingForThePoseItself) {
  EXPECT_THAT(vsd(strip(1, {1, 1, 1}), strip(1, {1, 1, 1}), {0, 1, 1, 0.5F}), Each(0.0));
}

TEST(SurfaceDiscrepancy, IsWholeWhereTheTwoDontMeetOrNothingIsSeen) {
  EXPECT_THAT(vsd(strip(0, {1, 1}), strip(4, {1, 1}), {}), Each(1.0));
  EXPECT_THAT(vsd(strip(0, {1, 1}), strip(0, {1, 1}), {0.5F, 0.5F}), Each(1.0));
  EXPECT_THAT(vsd(DepthPatch{}, DepthPatch{}, {}), Each(1.0));
}

// Four pixels each, three in common. No reading: all visible. Of 5 pixels 2 are seen at one pose alone; of
// the others one is off by 22 mm (0.22 diameters), one by 42 mm, one by nothing.
TEST(SurfaceDiscrepancy, CountsPixelsAsTheDefinitionDoes) {
  const auto errors = vsd(strip(1, {1, 1.022F, 1.042F, 1}), strip(2, {1.0F, 1, 1, 1}), {});
  // Columns: 1 estimate alone, 2: 1.022 and 1, 3: 1.042 and 1, 4: 1 and 1, 5 truth alone.
  EXPECT_THAT(errors, ElementsAre(0.8, 0.8, 0.8, 0.8, 0.6, 0.6, 0.6, 0.6, 0.4, 0.4));
}

// The reading decides what is visible: 14 mm behind it is, 16 mm is not; and the estimate is also seen
// wherever the truth is.
TEST(SurfaceDiscrepancy, TakesVisibilityFromTheDepthImage) {
  // Hidden in truth at column 0, where the estimate lies before the reading: seen at one pose alone.
  // Column 1: truth 14 mm behind the reading, seen; the estimate 30 mm behind is then seen too, 16 mm apart.
  // Column 2: both hidden: doesn't count.
  const auto errors =
      vsd(strip(0, {0.9F, 1.03F, 1.2F}), strip(0, {1.016F, 1.014F, 1.1F}), {1.0F, 1.0F, 1.0F});
  EXPECT_THAT(errors, ElementsAre(1.0, 1.0, 1.0, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5));
}

// At 45 degrees off the axis distances are longer than depths by the root of two.
TEST(SurfaceDiscrepancy, ComparesDistancesFromTheCentre) {
  const Intrinsics wide{3, 1, 1.0, 1.0, 1.0, 0.0};
  const auto at = [&](int u) {
    return surface_discrepancy(strip(u, {1.012F}), strip(u, {1.0F}), DepthImage(3, 1), RaySlopes(wide), 0.1);
  };
  EXPECT_EQ(at(1)[2], 0.0);  // 12 mm against 15 mm
  EXPECT_EQ(at(2)[2], 1.0);  // 17 mm
}

// --- Visible fractions
// ----------------------------------------------------------------------------------------

TEST(VisibleFractions, CountTheNearestOfEachPixel) {
  EXPECT_THAT(visible_fractions({strip(0, {1, 1, 1, 1}), strip(2, {0.9F, 1, 0, 1}), strip(6, {0, 0})}),
              ElementsAre(0.75, 2.0 / 3.0, 0.0));
}

}  // namespace
}  // namespace perch
