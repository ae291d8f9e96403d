#include "perch/io/polygon_mesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "perch/core/random.hpp"

namespace perch {
namespace {

/// Vector area of a closed polygon and of triangles: equal exactly when the triangles cover it once.
Eigen::Vector3d vector_area(const std::vector<Eigen::Vector3d>& polygon) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) sum += polygon[i].cross(polygon[(i + 1) % polygon.size()]);
  return sum / 2;
}

TEST(Triangulated, CoversStarShapedPolygonsOnceInAnyPlane) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const std::size_t n = 3 + random.below(12);
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
    const Eigen::Vector3d shift(random.normal(), random.normal(), random.normal());
    std::vector<Eigen::Vector3d> polygon;
    for (std::size_t i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
      const double radius = random.uniform(0.2, 1.0);  // mostly concave
      polygon.push_back(turn * Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), 0) +
                        shift);
    }
    const auto triangles = triangulated(polygon);
    ASSERT_EQ(triangles.size(), n - 2);
    const Eigen::Vector3d whole = vector_area(polygon);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double unsigned_sum = 0;
    for (const auto& t : triangles) {
      const Eigen::Vector3d part = vector_area({polygon[t[0]], polygon[t[1]], polygon[t[2]]});
      EXPECT_GE(part.dot(whole), -1e-12);
      sum += part;
      unsigned_sum += part.norm();
    }
    EXPECT_NEAR((sum - whole).norm(), 0, 1e-12);
    EXPECT_NEAR(unsigned_sum, whole.norm(), 1e-12);
  }
}

TEST(Triangulated, EndsOnPolygonsThatEncloseNothing) {
  const std::vector<Eigen::Vector3d> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(triangulated(line).size(), 3U);
}

TEST(Joined, JoinsEqualPlacesAndDropsTheRest) {
  PolygonMesh polygons;
  polygons.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}, {9, 9, 9}};
  polygons.corners = {0, 1, 2, 3, 2, 1, 0, 3, 1, 0, 1, 4};
  polygons.ends = {3, 6, 9, 11, 12};
  const Mesh mesh = joined(polygons, 0.001);
  EXPECT_EQ(mesh.vertices.size(), 3U);
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 1}}));
  EXPECT_EQ(mesh.vertices[1], Eigen::Vector3f(0.001F, 0, 0));
}

}  // namespace
}  // namespace perch
