#include "perch/sim/mesh_builder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace perch {
namespace {

using std::numbers::pi;

/// What a regular polygon with n corners on the unit circle covers.
double polygon_area(int n) {
  return 0.5 * n * std::sin(2 * pi / n);
}

TEST(MeshBuilder, CylinderHasTheVolumeOfItsPrism) {
  const double r = 0.05, h = 0.2;
  for (const int n : {3, 6, 48}) {
    const Mesh mesh = revolve(Profile{{0, 0}, {r, 0}, {r, h}, {0, h}}, n);
    EXPECT_TRUE(is_closed(mesh));
    EXPECT_NEAR(signed_volume(mesh) / (polygon_area(n) * r * r * h), 1.0, 1e-5);
  }
}

TEST(MeshBuilder, ConeWithItsTipOnTheAxis) {
  const double r = 0.05, h = 0.2;
  const Mesh mesh = revolve(Profile{{0, 0}, {r, 0}, {0, h}}, 40);
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_NEAR(signed_volume(mesh) / (polygon_area(40) * r * r * h / 3), 1.0, 1e-5);
}

TEST(MeshBuilder, SphereTendsToItsVolume) {
  const double r = 0.07;
  Profile profile{{0, 0}};
  for (int i = 1; i < 60; ++i) profile.push_back({r * std::sin(pi * i / 60), r - r * std::cos(pi * i / 60)});
  profile.push_back({0, 2 * r});
  const Mesh mesh = revolve(profile, 120);
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_NEAR(signed_volume(mesh) / (4.0 / 3.0 * pi * r * r * r), 1.0, 2e-3);
}

TEST(MeshBuilder, PolygonSectionMakesAPrismWithFlatSides) {
  const double r = 0.05, h = 0.1;
  const Mesh mesh = revolve(Profile{{0, 0}, {r, 0}, {r, h}, {0, h}}, 48, polygon_section(6));
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_NEAR(signed_volume(mesh) / (polygon_area(6) * r * r * h), 1.0, 1e-5);
  EXPECT_NEAR(mesh.bounds().sizes().x(), 2 * r, 1e-6);
  EXPECT_NEAR(mesh.bounds().sizes().y(), std::sqrt(3.0) * r, 1e-6);
}

TEST(MeshBuilder, BoxHasItsSizeWhateverItsCells) {
  const Eigen::Vector3d size(0.1, 0.06, 0.2);
  for (const double cell : {1.0, 0.03, 0.013}) {
    const Mesh mesh = box(size, cell);
    EXPECT_TRUE(is_closed(mesh));
    EXPECT_NEAR(signed_volume(mesh) / size.prod(), 1.0, 1e-6);
    EXPECT_TRUE(mesh.bounds().sizes().cast<double>().isApprox(size, 1e-6));
    EXPECT_EQ(mesh.bounds().min().z(), 0.0F);
  }
  EXPECT_EQ(box(size, 1.0).triangles.size(), 12U);
}

TEST(MeshBuilder, StraightTubeIsAnEllipticCylinder) {
  const std::vector<Eigen::Vector2d> path{{0.0, 0.1}, {0.02, 0.1}, {0.05, 0.1}};
  const Mesh mesh = tube(path, 0.01, 0.004, 32);
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_NEAR(signed_volume(mesh) / (polygon_area(32) * 0.01 * 0.004 * 0.05), 1.0, 1e-5);
  EXPECT_NEAR(mesh.bounds().sizes().y(), 0.02, 1e-6);
  EXPECT_NEAR(mesh.bounds().sizes().z(), 0.008, 1e-6);
}

TEST(MeshBuilder, BentTubeHasTheVolumeThatPappusGives) {
  const double bend = 0.05, r = 0.008;
  std::vector<Eigen::Vector2d> path;
  for (int i = 0; i <= 90; ++i) path.emplace_back(bend * std::cos(pi * i / 90), bend * std::sin(pi * i / 90));
  const Mesh mesh = tube(path, r, r, 48);
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_NEAR(signed_volume(mesh) / (pi * r * r * pi * bend), 1.0, 5e-3);
}

TEST(MeshBuilder, PointsAddedToAnOutlineChangeNothing) {
  const Profile profile{{0, 0}, {0.05, 0}, {0.03, 0.1}, {0, 0.1}};
  const Profile fine = subdivided(profile, 0.007);
  EXPECT_GT(fine.size(), profile.size() + 10);
  EXPECT_NEAR(signed_volume(revolve(fine, 24)) / signed_volume(revolve(profile, 24)), 1.0, 1e-5);
}

TEST(MeshBuilder, RoundedCornersStayWithinReach) {
  const Profile profile{{0, 0}, {0.05, 0}, {0.05, 0.1}, {0, 0.1}};
  const Profile smooth = rounded(profile, 0.01);
  const double sharp = signed_volume(revolve(profile, 48)), blunt = signed_volume(revolve(smooth, 48));
  EXPECT_LT(blunt, sharp);
  // A quadratic curve cuts a third of the corner's triangle off; the corner's ring is 2 pi 0.05 long at most.
  EXPECT_GT(blunt, sharp - 2 * (0.01 * 0.01 / 2) * 2 * pi * 0.05);
  EXPECT_TRUE(is_closed(revolve(smooth, 48)));
}

TEST(MeshBuilder, MovedScaledAndMergedKeepWhatTheyShould) {
  const Mesh mesh = box({0.1, 0.1, 0.1}, 0.05);
  Eigen::Isometry3d pose(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  pose.translation() << 0.3, -0.2, 0.1;
  EXPECT_NEAR(signed_volume(moved(mesh, pose)), 1e-3, 1e-8);
  EXPECT_NEAR(signed_volume(scaled(mesh, {2, 0.5, 3})), 3e-3, 1e-8);
  const Mesh both = merged({mesh, moved(mesh, pose)});
  EXPECT_TRUE(is_closed(both));
  EXPECT_NEAR(signed_volume(both), 2e-3, 1e-8);
}

}  // namespace
}  // namespace perch
