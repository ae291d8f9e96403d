#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "perch/baselines/model_cloud.hpp"
#include "perch/baselines/nearest_point.hpp"
#include "perch/baselines/observed_surface.hpp"
#include "perch/core/random.hpp"

namespace perch {
namespace {

/// A box with a corner at the origin; its triangles turned outwards, or all of them inwards.
Mesh box(const Eigen::Vector3f& size, bool outwards) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(size.x() * static_cast<float>(i & 1),
                               size.y() * static_cast<float>(i >> 1 & 1),
                               size.z() * static_cast<float>(i >> 2 & 1));
  for (const std::array<std::uint32_t, 4> quad : {std::array<std::uint32_t, 4>{0, 2, 3, 1},
                                                  {4, 5, 7, 6},
                                                  {0, 1, 5, 4},
                                                  {2, 6, 7, 3},
                                                  {0, 4, 6, 2},
                                                  {1, 3, 7, 5}})
    for (const std::array<std::uint32_t, 3> t :
         {std::array<std::uint32_t, 3>{quad[0], quad[1], quad[2]}, {quad[0], quad[2], quad[3]}})
      mesh.triangles.push_back(outwards ? t : std::array<std::uint32_t, 3>{t[0], t[2], t[1]});
  return mesh;
}

TEST(ModelCloud, CoversEveryFaceByItsArea) {
  const Eigen::Vector3f size(0.1F, 0.2F, 0.3F);
  for (const bool outwards : {true, false}) {
    constexpr std::size_t points = 2200;
    const SurfaceSamples cloud = model_cloud(box(size, outwards), points);
    ASSERT_EQ(cloud.size(), points);
    std::array<int, 6> on_face{};
    for (std::size_t i = 0; i < points; ++i) {
      const Eigen::Vector3f p = cloud.point(i), n = cloud.normal(i);
      Eigen::Index axis = 0;
      n.cwiseAbs().maxCoeff(&axis);
      const bool far = n[axis] > 0.0F;
      EXPECT_NEAR(n.cwiseAbs().sum(), 1.0F, 1e-5F);
      EXPECT_NEAR(p[axis], far ? size[axis] : 0.0F, 1e-6F) << "the normal points outwards";
      EXPECT_TRUE((p.array() >= -1e-6F).all() && (p.array() <= size.array() + 1e-6F).all());
      ++on_face[static_cast<std::size_t>(2 * axis + far)];
    }
    // Faces of 6, 3 and 2 parts in 22: two of each.
    const std::array<int, 6> expected{600, 600, 300, 300, 200, 200};
    for (std::size_t face = 0; face < 6; ++face) EXPECT_NEAR(on_face[face], expected[face], 1) << face;
  }
}

TEST(ModelCloud, IsEmptyWithoutArea) {
  Mesh line;
  line.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  line.triangles = {{0, 1, 2}};
  EXPECT_TRUE(model_cloud(line, 10).empty());
}

TEST(ModelCloud, ThinnedKeepsAPointNearEveryPoint) {
  const SurfaceSamples cloud = model_cloud(box({0.1F, 0.1F, 0.004F}, true), 3000);
  const float spacing = 0.01F;
  const SurfaceSamples kept = thinned(cloud, spacing);
  EXPECT_LT(kept.size(), cloud.size() / 4);
  const auto alike = [&](const SurfaceSamples& a, std::size_t i, const SurfaceSamples& b, std::size_t j) {
    return (a.point(i) - b.point(j)).norm() < spacing && a.normal(i).dot(b.normal(j)) > std::sqrt(0.75F);
  };
  for (std::size_t i = 0; i < kept.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(alike(kept, i, kept, j));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    bool near = false;
    for (std::size_t j = 0; j < kept.size() && !near; ++j) near = alike(cloud, i, kept, j);
    EXPECT_TRUE(near);
  }
}

TEST(NearestPoint, AgreesWithLookingAtAll) {
  Random random(5);
  const auto point = [&](double far) -> Eigen::Vector3f {
    return Eigen::Vector3d(random.uniform(-far, far), random.uniform(-far, far), random.uniform(-far, far))
        .cast<float>();
  };
  std::vector<Eigen::Vector3f> cloud;
  for (int i = 0; i < 500; ++i) cloud.push_back(point(0.3));
  const NearestPoint nearest(cloud);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3f from = point(1.0);
    float least = std::numeric_limits<float>::infinity();
    for (const Eigen::Vector3f& p : cloud) least = std::min(least, (p - from).squaredNorm());
    EXPECT_NEAR(nearest.squared_distance(from), least, 1e-6F * least);
  }
}

TEST(ObservedSurface, HasThePlanesNormal) {
  Camera camera;
  camera.intrinsics = {80, 60, 70, 70, 39.5, 29.5};
  camera.world_from_camera = world_from_model({0.3, -0.2, 0.7}, 0.5);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.2, -0.9).normalized();  // to the camera
  const Eigen::Vector3d on_plane(0, 0, 0.8);
  DepthImage depth(80, 60);
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 80; ++u) {
      const Eigen::Vector3d ray((u - 39.5) / 70, (v - 29.5) / 70, 1);
      depth(u, v) = static_cast<float>(normal.dot(on_plane) / normal.dot(ray));
    }
  const Observation observation(camera, depth, std::nullopt);
  const SurfaceSamples surface = observed_surface(observation, 0.08, SerialExecutor(), StopCondition());
  ASSERT_EQ(surface.size(), observation.size());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Vector3d n =
        camera.world_from_camera.linear().transpose() * surface.normal(i).cast<double>();
    EXPECT_GT(n.dot(normal), 0.9999);
    const Eigen::Vector3d p = camera.world_from_camera.inverse() * surface.point(i).cast<double>();
    EXPECT_NEAR(normal.dot(p - on_plane), 0.0, 1e-5);
  }
}

}  // namespace
}  // namespace perch
