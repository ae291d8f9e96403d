#include "perch/model/rest_orientation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "perch/core/random.hpp"

namespace perch {
namespace {

using Eigen::Vector3d;

/// A tetrahedron with its lowest point on z = 0.
Mesh wedge() {
  return {{{0.1F, 0.0F, 0.0F}, {0.3F, 0.05F, 0.0F}, {0.2F, 0.1F, 0.01F}, {0.15F, 0.02F, 0.2F}},
          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

Vector3d random_direction(Random& random) {
  const double z = random.uniform(-1.0, 1.0), angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return Vector3d(r * std::cos(angle), r * std::sin(angle), z).normalized();
}

TEST(RestOrientation, UpPointsUpByTheSmallestTurn) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Vector3d up = random_direction(random);
    const Eigen::Matrix3d turn = rotation_to_up(up);
    EXPECT_LT((turn * up - Vector3d::UnitZ()).norm(), 1e-12);
    EXPECT_LT((turn * turn.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(turn.determinant(), 1.0, 1e-12);
    // No turn that takes `up` to +z is smaller than the angle between them.
    EXPECT_NEAR((turn.trace() - 1.0) / 2.0, up.z(), 1e-9);
  }
}

TEST(RestOrientation, PolesAreExact) {
  EXPECT_EQ(rotation_to_up(Vector3d::UnitZ()), Eigen::Matrix3d::Identity());
  EXPECT_EQ(rotation_to_up(-Vector3d::UnitZ()), Eigen::Matrix3d(Vector3d(1.0, -1.0, -1.0).asDiagonal()));
  EXPECT_EQ(stood_from_model(wedge(), Vector3d::UnitZ()).matrix(), Eigen::Matrix4d::Identity());
  // Near them the turn stays a turn.
  for (const double tilt : {1e-6, 1e-8, 1e-10, 1e-13})
    for (const double pole : {1.0, -1.0}) {
      const Vector3d up = Vector3d(tilt, -2.0 * tilt, pole).normalized();
      const Eigen::Matrix3d turn = rotation_to_up(up);
      EXPECT_LT((turn * up - Vector3d::UnitZ()).norm(), 1e-8);
      EXPECT_NEAR(turn.determinant(), 1.0, 1e-9);
    }
}

TEST(RestOrientation, TheLowestPointComesToLieOnTheGround) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Vector3d up = random_direction(random);
    const Eigen::Isometry3d stood = stood_from_model(wedge(), up);
    const Mesh mesh = transformed(wedge(), stood);
    EXPECT_NEAR(mesh.bounds().min().z(), 0.0F, 1e-7F);
    EXPECT_EQ(stood.translation().head<2>(), Eigen::Vector2d(0.0, 0.0));
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      EXPECT_LT((mesh.vertices[v].cast<double>() - stood * wedge().vertices[v].cast<double>()).norm(), 1e-7);
    EXPECT_EQ(mesh.triangles, wedge().triangles) << "not mirrored";
  }
}

TEST(RestOrientation, NothingChangesToTheBitWhereNothingIsTurned) {
  const Mesh same = transformed(wedge(), Eigen::Isometry3d::Identity());
  for (std::size_t v = 0; v < same.vertices.size(); ++v) EXPECT_EQ(same.vertices[v], wedge().vertices[v]);
}

}  // namespace
}  // namespace perch
