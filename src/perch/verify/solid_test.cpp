#include "perch/verify/solid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "perch/verify/test_shapes.hpp"

namespace perch {
namespace {

using testing_verify::box;
using testing_verify::random_pose;
using testing_verify::sphere;

TEST(Solid, ABoxIsKnownExactly) {
  const Eigen::Vector3f size(0.2F, 0.1F, 0.06F);
  const Solid solid(box(-0.5F * size, size));
  EXPECT_TRUE(solid.is_closed());
  Random random(1);
  const Eigen::Vector3d half = 0.5 * size.cast<double>();
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d p(random.uniform(-0.15, 0.15), random.uniform(-0.1, 0.1),
                            random.uniform(-0.05, 0.05));
    const Eigen::Vector3d beyond = p.cwiseAbs() - half;
    const bool inside = (beyond.array() < 0.0).all();
    EXPECT_EQ(solid.is_inside(p), inside) << p.transpose();
    const double distance = inside ? -beyond.maxCoeff() : beyond.cwiseMax(0.0).norm();
    EXPECT_NEAR(solid.distance(p), distance, 1e-7) << p.transpose();
    EXPECT_EQ(solid.is_deeper(p, 0.01), inside && distance > 0.01) << p.transpose();
  }
  for (const Eigen::Vector3d& p : solid.surface_points())
    EXPECT_NEAR((p.cwiseAbs() - half).maxCoeff(), 0.0, 1e-7);
  EXPECT_EQ(solid.interior_points().size(), 4000U);
}

TEST(Solid, ASphereHasItsRadius) {
  const Solid solid(sphere(0.05, 60));
  ASSERT_TRUE(solid.is_closed());
  EXPECT_NEAR(solid.distance(Eigen::Vector3d::Zero()), 0.05, 1e-4);
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d p(random.uniform(-0.06, 0.06), random.uniform(-0.06, 0.06),
                            random.uniform(-0.06, 0.06));
    if (std::abs(p.norm() - 0.05) < 1e-4) continue;  // facets
    EXPECT_EQ(solid.is_inside(p), p.norm() < 0.05);
    EXPECT_NEAR(solid.distance(p), std::abs(p.norm() - 0.05), 1e-4);
  }
}

TEST(Solid, SurfaceIsCoveredDensely) {
  // Two triangles a face: the points between the corners are needed.
  const Eigen::Vector3f size(0.2F, 0.1F, 0.06F);
  const Solid solid(box(Eigen::Vector3f::Zero(), size));
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p(random.uniform(0.0, 0.2), random.uniform(0.0, 0.1), i % 2 ? 0.0 : 0.06);
    double nearest = 1.0;
    for (const Eigen::Vector3d& q : solid.surface_points()) nearest = std::min(nearest, (p - q).norm());
    EXPECT_LT(nearest, 0.002);
  }
}

TEST(Solid, AnOpenMeshHasNoInside) {
  Mesh mesh = box(Eigen::Vector3f::Zero(), {0.02F, 0.02F, 0.02F});
  mesh.triangles.pop_back();
  const Solid solid(mesh);
  EXPECT_FALSE(solid.is_closed());
  EXPECT_FALSE(solid.is_inside({0.01, 0.01, 0.01}));
  EXPECT_TRUE(solid.interior_points().empty());
  const Solid closed(box(Eigen::Vector3f::Zero(), {0.02F, 0.02F, 0.02F}));
  const Overlap overlap =
      overlap_of({&solid, Eigen::Isometry3d::Identity()}, {&closed, Eigen::Isometry3d::Identity()});
  EXPECT_EQ(overlap.share, 0.0);
}

TEST(Solid, EqualVerticesAreOne) {
  // Every triangle with corners of its own, as STL files have them.
  const Mesh whole = box(Eigen::Vector3f::Zero(), {0.1F, 0.1F, 0.1F});
  Mesh soup;
  for (const auto& triangle : whole.triangles) {
    const auto n = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t i : triangle) soup.vertices.push_back(whole.vertices[i]);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  EXPECT_TRUE(Solid(soup).is_closed());
}

// Boxes side by side along x, turned together at random: the second's face lies `depth` inside the first.
TEST(Overlap, OfBoxesIsAsDeepAsTheyEnterEachOther) {
  const Solid a(box(Eigen::Vector3f::Zero(), {0.2F, 0.2F, 0.2F})),
      b(box(Eigen::Vector3f::Zero(), {0.1F, 0.1F, 0.1F}));
  Random random(4);
  for (const double depth : {-0.01, 0.0, 0.003, 0.02, 0.045}) {
    const Eigen::Isometry3d turn = random_pose(random, {0.3, -0.2, 0.1});
    const Overlap overlap =
        overlap_of({&a, turn}, {&b, turn * Eigen::Translation3d(0.2 - depth, 0.05, 0.05)});
    EXPECT_NEAR(overlap.depth, std::max(0.0, depth), 1e-6) << depth;
    const double share = std::max(0.0, depth) / 0.1;
    EXPECT_LE(overlap.share, share + 1e-9);
    EXPECT_GE(overlap.share, share - 8.0 * std::sqrt(share * (1.0 - share) / 4000.0)) << depth;
  }
}

TEST(Overlap, OfASphereInABoxIsItsVolume) {
  const Solid ball(sphere(0.05, 40)), block(box({-0.2F, -0.2F, -0.4F}, {0.4F, 0.4F, 0.4F}));
  // Centre 0.02 m above the face: the cap below it.
  const double height = 0.03;
  const double cap = std::numbers::pi * height * height * (3.0 * 0.05 - height) / 3.0;
  const double share = cap / (4.0 / 3.0 * std::numbers::pi * 0.05 * 0.05 * 0.05);
  const Overlap overlap = overlap_of({&ball, Eigen::Isometry3d(Eigen::Translation3d(0.01, 0.02, 0.02))},
                                     {&block, Eigen::Isometry3d::Identity()});
  EXPECT_NEAR(overlap.depth, height, 1e-4);
  EXPECT_LE(overlap.share, share);
  EXPECT_GE(overlap.share, share - 0.06);
}

}  // namespace
}  // namespace perch
