#include "perch/sim/scene_maker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "perch/core/error.hpp"
#include "perch/model/solid_volume.hpp"
#include "perch/model/surface_samples.hpp"
#include "perch/sim/chess_pieces.hpp"
#include "perch/sim/scene_set.hpp"
#include "perch/sim/sensor_fields.hpp"

namespace perch {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// Small images; few models, so that little has to be built.
SceneRecipe small_recipe() {
  SceneRecipe recipe;
  recipe.width = 160;
  recipe.height = 120;
  recipe.models = {"can", "mug", "carton", "saucepan", "bottle_lying", "tuna_can"};
  recipe.min_objects = 2;
  recipe.max_objects = 4;
  return recipe;
}

TEST(SceneMaker, TheSeedDecides) {
  const SceneMaker maker(small_recipe());
  const MadeScene a = maker.make(5), b = SceneMaker(small_recipe()).make(5);
  EXPECT_EQ(truth_json(a), truth_json(b));
  EXPECT_EQ(a.simulated.scene.depth, b.simulated.scene.depth);
  EXPECT_EQ(a.objects, b.objects);
  EXPECT_NE(a.simulated.scene.depth, maker.make(6).simulated.scene.depth);
}

TEST(SceneMaker, KeepsToItsRecipe) {
  SceneRecipe recipe = small_recipe();
  recipe.min_objects = 3;
  recipe.repeats = 2;
  recipe.visible = {0.1, 0.7};
  recipe.distance = {0.75, 0.85};
  recipe.elevation_deg = {20, 30};
  recipe.azimuth_deg = {100, 150};
  const SceneMaker maker(recipe);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(seed);
    const MadeScene made = maker.make(seed);
    const Scene& scene = made.simulated.scene;
    EXPECT_GE(scene.objects.size(), 3U);
    EXPECT_LE(scene.objects.size(), 4U);
    std::map<std::size_t, int> copies;
    for (const SceneObject& object : scene.objects) ++copies[object.model];
    EXPECT_EQ(copies.size(), scene.objects.size() - 1) << "one model twice, all others once";
    const auto& visible = made.simulated.visible_fractions;
    const double least = *std::min_element(visible.begin(), visible.end());
    EXPECT_GE(least, 0.1);
    EXPECT_LE(least, 0.7);
    for (std::size_t i = 0; i < visible.size(); ++i) {
      EXPECT_EQ(visible[i], static_cast<double>(made.visible[i]) / static_cast<double>(made.alone[i]));
      const auto marked = std::count(made.objects.data().begin(), made.objects.data().end(), i + 1);
      EXPECT_EQ(marked, made.visible[i]);
      EXPECT_LE(std::abs(scene.truth[i].pose.x), 0.5 * recipe.workspace_x);
      EXPECT_LE(std::abs(scene.truth[i].pose.y), 0.5 * recipe.workspace_y);
    }
    const Eigen::Vector3d from = scene.camera.world_from_camera.translation() - Eigen::Vector3d(0, 0, 0.07);
    EXPECT_GE(from.norm(), 0.75 - 1e-9);
    EXPECT_LE(from.norm(), 0.85 + 1e-9);
    const double elevation = std::asin(from.z() / from.norm()) / degree;
    EXPECT_GE(elevation, 20 - 1e-9);
    EXPECT_LE(elevation, 30 + 1e-9);
    const double azimuth = std::atan2(from.x(), -from.y()) / degree;
    EXPECT_GE(azimuth, 100 - 1e-9);
    EXPECT_LE(azimuth, 150 + 1e-9);
  }
}

/// The meshes themselves: no sampled surface point of one lies in or on another.
TEST(SceneMaker, MeshesDontTouch) {
  const SceneMaker maker(small_recipe());
  for (std::uint64_t seed = 30; seed < 33; ++seed) {
    const Scene scene = maker.make(seed).simulated.scene;
    for (const TruthPose& a : scene.truth) {
      const SolidVolume solid(scene.models[a.model].mesh, 0.02);
      for (const TruthPose& b : scene.truth) {
        if (&a == &b) continue;
        const Eigen::Isometry3d a_from_b =
            world_from_model(a.pose, 0).inverse() * world_from_model(b.pose, 0);
        for (const Eigen::Vector3f& p : sample_surface(scene.models[b.model].mesh, 0.005F))
          ASSERT_LE(solid.depth_lower_bound((a_from_b * p.cast<double>()).cast<float>()), 0.0F) << seed;
      }
    }
  }
}

TEST(SceneMaker, TheTableIsThePlaneAndTheMaskTellsItFromObjects) {
  SceneRecipe recipe = small_recipe();
  recipe.sensor = DepthSensorSettings::clean();
  recipe.table = true;
  const MadeScene made = SceneMaker(recipe).make(3);
  const Scene& scene = made.simulated.scene;
  const RaySlopes rays(scene.camera.intrinsics);
  int on_table = 0;
  for (int v = 0; v < 120; ++v)
    for (int u = 0; u < 160; ++u) {
      const bool masked = (*scene.mask)(u, v) != 0;
      EXPECT_EQ(masked, made.objects(u, v) != 0);
      if (masked || scene.depth(u, v) == 0) continue;
      ++on_table;
      const Eigen::Vector3d p =
          scene.camera.world_from_camera * rays.point(u, v, scene.depth(u, v)).cast<double>();
      EXPECT_NEAR(p.z(), 0.0, 1e-6);
      EXPECT_LE(std::abs(p.x()), 0.5 * recipe.workspace_x + table_margin + 1e-6);
      EXPECT_LE(std::abs(p.y()), 0.5 * recipe.workspace_y + table_margin + 1e-6);
    }
  EXPECT_GT(on_table, 1000);
}

TEST(SceneMaker, WithoutTheTableItsReadingsAreRemovedAndNoOthers) {
  for (const std::string& sensor : sensor_names()) {
    SCOPED_TRACE(sensor);
    SceneRecipe recipe = small_recipe();
    recipe.sensor = named_sensor(sensor);
    recipe.table = true;
    const Scene with = SceneMaker(recipe).make(4).simulated.scene;
    recipe.table = false;
    const Scene without = SceneMaker(recipe).make(4).simulated.scene;
    EXPECT_FALSE(without.mask.has_value());
    for (std::size_t i = 0; i < with.depth.size(); ++i)
      ASSERT_EQ(without.depth[i], (*with.mask)[i] != 0 ? with.depth[i] : 0.0F);
  }
}

TEST(SceneMaker, ChessPiecesStandOnTheirSquares) {
  SceneRecipe recipe = SceneRecipe::chess();
  recipe.width = 160;
  recipe.height = 120;
  const SceneMaker maker(recipe);
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const Scene scene = maker.make(seed).simulated.scene;
    EXPECT_EQ(scene.models.size(), 6U);
    EXPECT_EQ(scene.objects.size(), 12U);
    std::set<std::pair<int, int>> squares;
    for (const TruthPose& truth : scene.truth) {
      const double column = truth.pose.x / chess_square + 3.5, row = truth.pose.y / chess_square + 3.5;
      EXPECT_NEAR(column, std::round(column), 0.004 / chess_square + 1e-9);
      EXPECT_NEAR(row, std::round(row), 0.004 / chess_square + 1e-9);
      EXPECT_TRUE(column > -0.5 && column < 7.5 && row > -0.5 && row < 7.5);
      squares.insert({static_cast<int>(std::lround(column)), static_cast<int>(std::lround(row))});
    }
    EXPECT_EQ(squares.size(), 12U);
  }
}

TEST(SceneMaker, SeedsOfASetDiffer) {
  std::set<std::uint64_t> seeds;
  for (std::uint64_t set = 0; set < 20; ++set)
    for (std::uint64_t i = 0; i < 500; ++i) seeds.insert(scene_seed(set, i));
  EXPECT_EQ(seeds.size(), 10000U);
}

TEST(SceneMaker, RefusesWhatCannotBe) {
  const auto refused = [](auto change) {
    SceneRecipe recipe = small_recipe();
    change(recipe);
    EXPECT_THROW(recipe.check(), InputError);
  };
  refused([](auto& r) { r.models = {}; });
  refused([](auto& r) { r.models = {"anvil"}; });
  refused([](auto& r) { r.models = {"can", "mug", "can", "tin", "jar"}; });
  refused([](auto& r) { r.min_objects = 0; });
  refused([](auto& r) { r.max_objects = 1; });
  refused([](auto& r) { r.max_objects = 7; });
  refused([](auto& r) { r.max_objects = 256; });
  refused([](auto& r) { r.repeats = 0; });
  refused([](auto& r) { r.repeats = 3; });
  refused([](auto& r) { r.visible = {0.5, 0.4}; });
  refused([](auto& r) { r.visible = {0, 1.1}; });
  refused([](auto& r) { r.distance = {std::nan(""), 1}; });
  refused([](auto& r) { r.elevation_deg = {-1, 10}; });
  refused([](auto& r) { r.azimuth_deg = {0, 361}; });
  refused([](auto& r) { r.workspace_x = 0; });
  refused([](auto& r) { r.least_gap = -1; });
  refused([](auto& r) { r.width = 0; });
  refused([](auto& r) { r.sensor.flying_pixels = 2; });
}

TEST(SensorFields, EachCanBeSetAndReadBackAndNothingElse) {
  for (const std::string& name : sensor_names()) {
    const DepthSensorSettings preset = named_sensor(name);
    EXPECT_NO_THROW(preset.check()) << name;
    DepthSensorSettings copy = DepthSensorSettings::kinect();
    for (const SensorField& field : sensor_fields()) {
      set_sensor_field(copy, field.key, field.get(preset));
      EXPECT_EQ(field.get(copy), field.get(preset)) << field.key;
      EXPECT_THROW(set_sensor_field(copy, field.key, "?"), InvalidSetting);
    }
    EXPECT_NO_THROW(copy.check()) << name;
  }
  DepthSensorSettings settings;
  EXPECT_THROW(set_sensor_field(settings, "sensor.colour", "1"), InvalidSetting);
  EXPECT_THROW(named_sensor("lidar"), InvalidSetting);
}

}  // namespace
}  // namespace perch
