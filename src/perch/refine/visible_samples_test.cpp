// Which samples are kept, one at a time in double.

#include "perch/refine/visible_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "perch/refine/icp_test_support.hpp"

namespace perch {
namespace {

/// Samples of an object, and what may stand in front of them.
struct Scene {
  Camera camera;
  SurfaceSamples view;
  Pose pose;
  double origin_z = 0.0, occlusion = 0.0;
  DepthPatch in_front;
  DepthImage observed;

  Observation observation() const { return Observation(camera, observed, std::nullopt); }
};

/// Samples anywhere in a box that may reach out of the image and behind the camera, surfaces in front of and
/// behind them.
Scene random_scene(Random& random) {
  Scene scene;
  scene.camera = tilted_camera();
  scene.camera.intrinsics = {90, 70, 110.0, 105.0, 44.3, 35.8};
  scene.pose = {random.uniform(-0.2, 0.2), random.uniform(-0.9, 0.2), random.uniform(-4, 4)};
  scene.origin_z = random.uniform(-0.1, 0.3);
  scene.occlusion = random.uniform(0.0, 0.1);
  const auto count = 1 + random.below(400);
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = [&](double size) { return static_cast<float>(random.uniform(-size, size)); };
    scene.view.push_back({number(0.2), number(0.2), number(0.1)},
                         Eigen::Vector3f(number(1.0), number(1.0), number(1.0)).normalized());
  }
  const auto depth = [&] {
    return random.below(3) == 0 ? no_surface : static_cast<float>(random.uniform(0.2, 1.5));
  };
  const int u = static_cast<int>(random.below(40)), v = static_cast<int>(random.below(30));
  scene.in_front.window = {u, v, u + 1 + static_cast<int>(random.below(50)),
                           v + 1 + static_cast<int>(random.below(40))};
  scene.in_front.depth.resize(
      static_cast<std::size_t>(scene.in_front.window.width() * scene.in_front.window.height()));
  for (float& z : scene.in_front.depth) z = depth();
  scene.observed = DepthImage(90, 70, 0.5F);
  for (int row = 0; row < 70; ++row)
    for (int column = 0; column < 90; ++column) {
      const float z = depth();
      scene.observed(column, row) = z < no_surface ? z : 0.0F;
    }
  return scene;
}

struct Kept {
  SurfaceSamples samples;
  Sight sight;
};

Kept kept(const Scene& scene, const DepthPatch* in_front, const Observation& observation) {
  Kept found;
  visible_samples(scene.view, scene.pose, scene.origin_z, in_front, observation, scene.occlusion,
                  found.samples, found.sight);
  return found;
}

/// A sample's pixel and depth; whether it is in view is out of the question where it is not `sure`.
struct Projected {
  Eigen::Vector3d point, normal;  ///< world frame
  double z = 0.0;                 ///< metres
  int u = 0, v = 0;
  bool in_image = false, sure = true;
};

Projected project(const Scene& scene, std::size_t i) {
  const Eigen::AngleAxisd turn(scene.pose.yaw, Eigen::Vector3d::UnitZ());
  Projected p;
  p.normal = turn * scene.view.normal(i).cast<double>();
  p.point =
      turn * scene.view.point(i).cast<double>() + Eigen::Vector3d(scene.pose.x, scene.pose.y, scene.origin_z);
  const Eigen::Vector3d c = scene.camera.world_from_camera.inverse() * p.point;
  const Intrinsics& k = scene.camera.intrinsics;
  p.z = c.z();
  p.sure = std::abs(p.z) > 0.01;  // so near, a pixel is less than rounding
  if (!(p.z > 0.0)) return p;
  const double u = k.fx * c.x() / c.z() + k.cx, v = k.fy * c.y() / c.z() + k.cy;
  p.in_image = u >= -0.5 && v >= -0.5 && u < k.width - 0.5 && v < k.height - 0.5;
  for (const double place : {u, v}) p.sure = p.sure && std::abs(place - std::floor(place) - 0.5) > 1e-3;
  if (!p.in_image) return p;
  p.u = static_cast<int>(std::floor(u + 0.5));
  p.v = static_cast<int>(std::floor(v + 0.5));
  return p;
}

class VisibleSamplesTest : public testing::Test {
 protected:
  /// Compares what is kept, sample by sample.
  void check(const Scene& scene, const DepthPatch* in_front) {
    const Kept found = kept(scene, in_front, scene.observation());
    constexpr double rounding = 1e-5;  // metres
    std::size_t next = 0;
    const auto is_next = [&](const Projected& p) {
      return next < found.samples.size() &&
             (found.samples.point(next).cast<double>() - p.point).norm() < rounding &&
             (found.samples.normal(next).cast<double>() - p.normal).norm() < rounding;
    };
    for (std::size_t i = 0; i < scene.view.size(); ++i) {
      const Projected p = project(scene, i);
      bool keep = p.in_image, sure = p.sure;
      if (p.in_image) {
        const double front = in_front == nullptr ? no_surface : in_front->at_or_none(p.u, p.v);
        const double observed = scene.observed(p.u, p.v), behind = p.z - observed;
        keep = !(front < p.z) && !(observed > 0.0 && behind > scene.occlusion);
        sure = sure && std::abs(front - p.z) > rounding && std::abs(behind - scene.occlusion) > rounding;
      }
      if (!sure) {
        next += is_next(p);
        continue;
      }
      ++(keep ? kept_ : left_);
      if (!keep) continue;
      ASSERT_TRUE(is_next(p)) << "sample " << i;
      ++next;
    }
    EXPECT_EQ(next, found.samples.size());
  }

  int kept_ = 0, left_ = 0;
};

TEST_F(VisibleSamplesTest, AreThoseInTheImageThatNothingHides) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Scene scene = random_scene(random);
    check(scene, &scene.in_front);
    check(scene, nullptr);
  }
  EXPECT_GT(kept_, 3000);
  EXPECT_GT(left_, 3000);
}

TEST(Sight, BoundsThePixelsLookedAt) {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Scene scene = random_scene(random);
    Window window;
    double farthest = 0.0;
    bool sure = true;
    for (std::size_t i = 0; i < scene.view.size(); ++i) {
      const Projected p = project(scene, i);
      sure = sure && p.sure;
      if (!p.in_image) continue;
      window = bounding(window, {p.u, p.v, p.u + 1, p.v + 1});
      farthest = std::max(farthest, p.z);
    }
    const Observation observation = scene.observation();
    const Sight none = kept(scene, nullptr, observation).sight;
    EXPECT_TRUE(none.window.empty()) << "no parent scene to look at";
    EXPECT_EQ(none.farthest, 0.0F);
    const Sight sight = kept(scene, &scene.in_front, observation).sight;
    if (!sure) continue;
    ++compared;
    EXPECT_NEAR(sight.farthest, farthest, 1e-5);
    EXPECT_EQ(sight.window, window);
  }
  EXPECT_GT(compared, 50);
}

TEST(Sight, AddsUp) {
  Random random(1);
  const Scene scene = random_scene(random);
  SurfaceSamples samples;
  Sight sight{{2, 3, 5, 80}, 9.0F};
  const Sight alone = kept(scene, &scene.in_front, scene.observation()).sight;
  visible_samples(scene.view, scene.pose, scene.origin_z, &scene.in_front, scene.observation(),
                  scene.occlusion, samples, sight);
  EXPECT_EQ(sight.window, bounding({2, 3, 5, 80}, alone.window));
  EXPECT_EQ(sight.farthest, 9.0F);
}

// What was made without regard to surfaces that are out of sight is what it would be with them, to the bit.
TEST(Sight, SurfacesOutOfItChangeNothing) {
  int beside = 0, behind = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Scene scene = random_scene(random);
    const Observation observation = scene.observation();
    const Kept expected = kept(scene, &scene.in_front, observation);
    DepthPatch other{scene.camera.intrinsics.window(), std::vector<float>(90 * 70, no_surface)};
    for (int v = 0; v < 70; ++v)
      for (int u = 0; u < 90; ++u) {
        float& z = other.depth[other.index(u, v)];
        z = scene.in_front.at_or_none(u, v);
        if (!expected.sight.window.contains(u, v)) {
          z = static_cast<float>(random.uniform(0.0, 0.3));
          ++beside;
        } else if (!(z < expected.sight.farthest)) {
          z = expected.sight.farthest + static_cast<float>(random.below(2)) * 0.1F;
          ++behind;
        }
      }
    const Kept found = kept(scene, &other, observation);
    EXPECT_EQ(found.samples.x, expected.samples.x);
    EXPECT_EQ(found.samples.y, expected.samples.y);
    EXPECT_EQ(found.samples.z, expected.samples.z);
    EXPECT_EQ(found.samples.nx, expected.samples.nx);
    EXPECT_EQ(found.samples.ny, expected.samples.ny);
    EXPECT_EQ(found.samples.nz, expected.samples.nz);
    EXPECT_EQ(found.sight.window, expected.sight.window);
    EXPECT_EQ(found.sight.farthest, expected.sight.farthest);
  }
  EXPECT_GT(beside, 10000);
  EXPECT_GT(behind, 10000);
}

}  // namespace
}  // namespace perch
