// Scenes in which things stand that no model describes.

#include <gtest/gtest.h>

#include <algorithm>

#include "perch/core/error.hpp"
#include "perch/core/random.hpp"
#include "perch/localize/localize.hpp"
#include "perch/localize/prepare.hpp"
#include "perch/sim/scene_generator.hpp"
#include "perch/sim/simulated_scene.hpp"

namespace perch {
namespace {

/// A tabletop without noise of which the last `strangers` objects are not looked for.
Scene with_strangers(std::uint64_t seed, int objects, int strangers) {
  TabletopOptions options;
  options.min_objects = options.max_objects = objects;
  options.noise = false;
  options.width = 160;
  options.height = 120;
  options.least_visible = 0.3;
  Scene scene = random_tabletop(seed, options).scene;
  for (int i = 0; i < strangers; ++i) {
    scene.objects.pop_back();
    scene.truth.pop_back();
  }
  scene.clutter = true;
  return scene;
}

std::vector<PlacedModel> truth_of(const Scene& scene) {
  std::vector<PlacedModel> placed;
  for (const TruthPose& truth : scene.truth) placed.push_back({truth.model, truth.pose});
  return placed;
}

ScoreRecord cost_at_truth(const Scene& scene, const Settings& settings) {
  const SerialExecutor executor;
  return score(prepare(scene, settings, executor), {truth_of(scene)}, settings, executor).front();
}

// A wall in front of everything: every rendered point is hidden, and the weight says how many are charged.
TEST(Clutter, ChargesTheStatedShareOfWhatAWallHides) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = with_strangers(seed, 3, 1);
    const double height = *scene.table_height;
    scene.depth = DepthImage(scene.depth.width(), scene.depth.height(), 0.3F);
    scene.mask = Image<std::uint8_t>(scene.depth.width(), scene.depth.height(), 0);
    // I must hold something: a point where no object is seen.
    (*scene.mask)(0, 0) = 255;
    scene.depth(0, 0) = 0.9F;
    Settings settings;
    settings.candidates.cost.clutter_weight = 1.0;
    scene.clutter = false;
    const std::int64_t all = cost_at_truth(scene, settings).cost.cost_rendered;
    ASSERT_GT(all, 300);
    scene.clutter = true;
    scene.workspace.reset();
    scene.table_height = height;
    const auto rendered = [&](double weight) {
      settings.candidates.cost.clutter_weight = weight;
      const SerialExecutor executor;
      return score(scene, {truth_of(scene)}, settings, executor).front().cost.cost_rendered;
    };
    EXPECT_EQ(rendered(1.0), all);
    std::int64_t last = 0;
    for (const int n : {1, 16, 32, 48}) {
      const std::int64_t charged = rendered(n / 64.0);
      EXPECT_NEAR(static_cast<double>(charged), static_cast<double>(all) * n / 64.0,
                  0.05 * static_cast<double>(all));
      EXPECT_GT(charged, last);
      last = charged;
    }
  }
}

// Readings of what no object can reach: behind the table, above the highest model.
TEST(Clutter, WhatNoObjectReachesCostsNothing) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Scene scene = with_strangers(seed, 3, 1);
    const Settings settings;
    const ScoreRecord before = cost_at_truth(scene, settings);
    Scene more = scene;
    Random random(seed);
    int added = 0;
    for (std::size_t i = 0; i < more.depth.size(); ++i)
      if (more.depth[i] == 0.0F && random.uniform() < 0.5) {
        more.depth[i] = static_cast<float>(random.uniform(6.0, 9.0));
        ++added;
      }
    ASSERT_GT(added, 1000);
    const ScoreRecord after = cost_at_truth(more, settings);
    EXPECT_EQ(after.observed_points, before.observed_points);
    EXPECT_EQ(after.cost.cost, before.cost.cost);
  }
}

TEST(Clutter, PointsCostNothingWhereAskedFor) {
  Settings settings;
  const Scene scene = with_strangers(3, 4, 2);
  EXPECT_GT(cost_at_truth(scene, settings).cost.cost_observed, 100);
  settings.candidates.cost.clutter_points = ClutterPoints::ignore;
  const ScoreRecord record = cost_at_truth(scene, settings);
  EXPECT_EQ(record.cost.cost_observed, 0);
  EXPECT_GT(record.observed_points, 1000);
}

TEST(Clutter, AbsentObjectsNeedPointsThatCost) {
  Settings settings;
  settings.candidates.cost.clutter_points = ClutterPoints::ignore;
  Scene scene = with_strangers(3, 3, 1);
  scene.objects.back().optional = true;
  const SerialExecutor executor;
  try {
    localize(scene, settings, executor, StopCondition());
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("cost.clutter_points=charge"), std::string::npos);
  }
}

TEST(ClutterHeavy, FindsObjectsAmongStrangers) {
  int right = 0, wanted = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Settings settings;
    settings.candidates.grid.resolution = 0.06;
    settings.candidates.grid.yaw_resolution = 0.7854;
    settings.ambiguity.trials = 0;
    const SerialExecutor executor;
    const Scene scene = prepare(with_strangers(seed, 5, 3), settings, executor);
    for (const ClutterPoints points : {ClutterPoints::charge, ClutterPoints::ignore}) {
      settings.candidates.cost.clutter_points = points;
      const Result result = localize(scene, settings, executor, StopCondition());
      ASSERT_EQ(result.status, Status::solved);
      ASSERT_TRUE(result.guarantee.clutter);
      EXPECT_LE(result.lower_bound, *result.search_cost);
      EXPECT_LE(*result.search_cost, 3 * result.lower_bound);
      if (points == ClutterPoints::ignore) continue;
      for (const TruthPose& truth : scene.truth) {
        ++wanted;
        right += std::any_of(result.objects.begin(), result.objects.end(), [&](const ObjectResult& o) {
          return o.model == scene.models[truth.model].name &&
                 std::hypot(o.pose.x - truth.pose.x, o.pose.y - truth.pose.y) < 0.01;
        });
      }
    }
  }
  EXPECT_GE(right, wanted * 9 / 10) << right << " of " << wanted;
}

}  // namespace
}  // namespace perch
