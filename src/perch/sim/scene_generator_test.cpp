#include "perch/sim/scene_generator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "perch/core/error.hpp"
#include "perch/model/solid_volume.hpp"
#include "perch/model/surface_samples.hpp"
#include "perch/render/rasterizer.hpp"
#include "perch/sim/footprint.hpp"
#include "perch/sim/parametric_models.hpp"

namespace perch {
namespace {

TabletopOptions quick() {
  TabletopOptions options;
  options.width = 160;
  options.height = 120;
  return options;
}

TEST(SceneGenerator, TheSeedDecides) {
  const SimulatedScene a = random_tabletop(5, quick()), b = random_tabletop(5, quick());
  EXPECT_EQ(a.scene.depth, b.scene.depth);
  EXPECT_EQ(a.scene.objects, b.scene.objects);
  EXPECT_EQ(a.visible_fractions, b.visible_fractions);
  ASSERT_EQ(a.scene.truth.size(), b.scene.truth.size());
  for (std::size_t i = 0; i < a.scene.truth.size(); ++i)
    EXPECT_EQ(a.scene.truth[i].pose, b.scene.truth[i].pose);
  EXPECT_NE(a.scene.depth, random_tabletop(6, quick()).scene.depth);
}

TEST(SceneGenerator, ObjectsStandApartInViewAndInTheWorkspace) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    TabletopOptions options = quick();
    if (seed % 2 == 1) options.camera_distance = 0.62;  // the workspace's borders are out of view
    const SimulatedScene simulated = random_tabletop(seed, options);
    const Scene& scene = simulated.scene;
    EXPECT_GE(scene.objects.size(), 3U);
    EXPECT_LE(scene.objects.size(), 5U);
    ASSERT_EQ(scene.truth.size(), scene.objects.size());
    ASSERT_EQ(simulated.visible_fractions.size(), scene.objects.size());
    Rasterizer rasterizer(scene.camera.intrinsics);
    for (std::size_t i = 0; i < scene.truth.size(); ++i) {
      const auto& [model, pose, symmetry, has_models_symmetry] = scene.truth[i];
      EXPECT_EQ(model, scene.objects[i].model);
      EXPECT_EQ(symmetry, scene.models[model].symmetry);
      EXPECT_GE(pose.x, scene.workspace->x_min);
      EXPECT_LE(pose.x, scene.workspace->x_max);
      EXPECT_GE(pose.y, scene.workspace->y_min);
      EXPECT_LE(pose.y, scene.workspace->y_max);
      EXPECT_GE(simulated.visible_fractions[i], options.least_visible);
      EXPECT_LE(simulated.visible_fractions[i], 1.0);
      const Window window = rasterizer
                                .render(scene.models[model].mesh,
                                        scene.camera.world_from_camera.inverse() * world_from_model(pose, 0))
                                .window;
      EXPECT_TRUE(window.u0 > 0 && window.v0 > 0 && window.u1 < 160 && window.v1 < 120);
    }
  }
}

/// The meshes themselves, not their footprints: no sampled surface point of one lies in or on another.
TEST(SceneGenerator, MeshesDontTouch) {
  for (std::uint64_t seed = 30; seed < 34; ++seed) {
    const Scene scene = random_tabletop(seed, quick()).scene;
    for (const TruthPose& a : scene.truth) {
      const SolidVolume solid(scene.models[a.model].mesh, 0.02);
      for (const TruthPose& b : scene.truth) {
        if (&a == &b) continue;
        const Eigen::Isometry3d a_from_b =
            world_from_model(a.pose, 0).inverse() * world_from_model(b.pose, 0);
        for (const Eigen::Vector3f& p : sample_surface(scene.models[b.model].mesh, 0.004F))
          ASSERT_LE(solid.depth_lower_bound((a_from_b * p.cast<double>()).cast<float>()), 0.0F);
      }
    }
  }
}

TEST(SceneGenerator, WithoutNoiseItIsTheRendering) {
  TabletopOptions options = quick();
  options.noise = false;
  const SimulatedScene simulated = random_tabletop(9, options);
  const Scene& scene = simulated.scene;
  const Eigen::Isometry3d camera_from_world = scene.camera.world_from_camera.inverse();
  Rasterizer rasterizer(scene.camera.intrinsics);
  DepthImage nearest(160, 120);
  Image<int> owner(160, 120, -1);
  std::vector<double> alone, visible(scene.truth.size(), 0.0);
  for (std::size_t i = 0; i < scene.truth.size(); ++i) {
    const auto& [model, pose, symmetry, has_models_symmetry] = scene.truth[i];
    const DepthPatch patch =
        rasterizer.render(scene.models[model].mesh, camera_from_world * world_from_model(pose, 0));
    alone.push_back(static_cast<double>(patch.covered()));
    for (int v = 0; v < 120; ++v)
      for (int u = 0; u < 160; ++u)
        if (const float z = patch.at_or_none(u, v);
            z < no_surface && (nearest(u, v) == 0 || z < nearest(u, v))) {
          nearest(u, v) = z;
          owner(u, v) = static_cast<int>(i);
        }
  }
  EXPECT_EQ(scene.depth, nearest);
  for (std::size_t i = 0; i < owner.size(); ++i)
    if (owner[i] >= 0) ++visible[static_cast<std::size_t>(owner[i])];
  for (std::size_t i = 0; i < visible.size(); ++i)
    EXPECT_NEAR(simulated.visible_fractions[i], visible[i] / alone[i], 1e-12);
  EXPECT_LT(*std::min_element(simulated.visible_fractions.begin(), simulated.visible_fractions.end()), 0.95)
      << "this seed has nothing hidden, so it tests nothing";
}

TEST(SceneGenerator, KeepsToItsOptions) {
  TabletopOptions options = quick();
  options.min_objects = options.max_objects = 4;
  options.models = {"mug", "can", "tin", "glass"};
  options.repeats = false;
  const Scene all = random_tabletop(1, options).scene;
  EXPECT_EQ(all.models.size(), 4U);
  EXPECT_EQ(all.objects, (std::vector<SceneObject>{0, 1, 2, 3}));
  options.repeats = true;
  options.models = {"mug"};
  const Scene mugs = random_tabletop(1, options).scene;
  ASSERT_EQ(mugs.models.size(), 1U);
  EXPECT_EQ(mugs.objects, (std::vector<SceneObject>{0, 0, 0, 0}));
  EXPECT_EQ(mugs.models[0].name, "mug");
}

TEST(SceneGeneratorHeavy, RefusesWhatCannotBe) {
  const auto refused = [](auto change) {
    TabletopOptions options = quick();
    change(options);
    EXPECT_THROW(random_tabletop(1, options), InputError);
  };
  refused([](auto& o) { o.min_objects = 0; });
  refused([](auto& o) { o.max_objects = 2; });
  refused([](auto& o) { o.models = {"teapot"}; });
  refused([](auto& o) { o.width = 0; });
  refused([](auto& o) { o.least_visible = 1.5; });
  refused([](auto& o) { o.camera_elevation = 1.6; });
  refused([](auto& o) { o.sensor.dropout_rate = 2; });
  refused([](auto& o) {  // no room
    o.models = {"bowl"};
    o.workspace = {-0.02, 0.02, -0.02, 0.02};
  });
  refused([](auto& o) {
    o.repeats = false;
    o.models = {"mug", "can"};
  });
}

TEST(Camera, LooksAtItsTargetWithTheImageUpright) {
  const Intrinsics k{640, 480, 525, 525, 319.5, 239.5};
  const Camera camera = camera_looking_at(k, {0.3, -0.8, 0.6}, {0.1, 0, 0.1});
  const Eigen::Isometry3d camera_from_world = camera.world_from_camera.inverse();
  const Eigen::Vector3d target = camera_from_world * Eigen::Vector3d(0.1, 0, 0.1);
  EXPECT_NEAR(target.head<2>().norm(), 0, 1e-12);
  EXPECT_GT(target.z(), 0);
  EXPECT_LT((camera_from_world * Eigen::Vector3d(0.1, 0, 0.2)).y(), 0)
      << "up in the world is up in the image";
  EXPECT_NEAR(camera.world_from_camera.linear().determinant(), 1, 1e-12);
}

}  // namespace
}  // namespace perch
