#include "perch/verify/verify.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "perch/core/error.hpp"
#include "perch/verify/test_shapes.hpp"

namespace perch {
namespace {

using testing_verify::box;

/// A block of 0.3 m and a plate of 0.4 x 0.1 x 0.1 m that floats 0.1 m above the table at z = 0.5. The camera
/// looks straight down from z = 2.5.
Scene block_and_plate() {
  Scene scene;
  scene.camera.intrinsics = {80, 60, 80.0, 80.0, 39.7, 29.6};
  scene.camera.world_from_camera.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  scene.camera.world_from_camera.translation() << 0.0, 0.0, 2.5;
  scene.depth = DepthImage(80, 60, 0.0F);
  scene.depth(10, 10) = 2.0F;
  scene.table_height = 0.5;
  scene.models = {{"block", box({-0.15F, -0.15F, 0.0F}, {0.3F, 0.3F, 0.3F})},
                  {"plate", box({-0.2F, -0.05F, 0.0F}, {0.4F, 0.1F, 0.1F}), Symmetry::none(), 0.1}};
  scene.objects = {0, 1};
  return scene;
}

/// The plate's end `depth` metres inside the block.
ReportedResult entered_by(double depth) {
  ReportedResult r;
  r.observed_points = 1;
  r.guarantee.w = 3.0;
  r.search_objects = {{0, {}}, {1, {0.35 - depth, 0.0, std::acos(-1.0)}}};
  for (const PlacedModel& placed : r.search_objects) {
    ReportedObject object;
    object.model = placed.model;
    object.pose = placed.pose;
    r.objects.push_back(object);
  }
  return r;
}

std::vector<Check> named(const Checks& checks, const std::string& part) {
  std::vector<Check> found;
  std::copy_if(checks.begin(), checks.end(), std::back_inserter(found),
               [&](const Check& check) { return check.name.find(part) != std::string::npos; });
  return found;
}

// The limits here: 10 mm and 4.1 voxels of 0.3 / 72 m and 3.8 of 0.4 / 72 m, or the other way about, deep;
// 0.35 and 0.05 of the plate, which is 0.4 m long.
TEST(VerifyFacade, SolidsThatEnterEachOtherDeeplyCollide) {
  const Scene scene = block_and_plate();
  Settings settings;
  for (const double depth : {-0.01, 0.005, 0.045, 0.06}) {
    const Checks checks = verify(scene, entered_by(depth), settings);
    const auto collisions = named(checks, "don't collide");
    ASSERT_EQ(collisions.size(), 1U);
    EXPECT_EQ(collisions[0].holds, depth < 0.05) << depth << ": " << collisions[0].recomputed;
    EXPECT_EQ(collisions[0].recomputed.find(fmt::format("{:.1f} mm deep", 1000.0 * std::max(0.0, depth))), 0U)
        << collisions[0].recomputed;
  }
}

TEST(VerifyFacade, SolidsThatShareMuchCollide) {
  const Scene scene = block_and_plate();
  Settings settings;
  settings.candidates.collision.penetration = 1.0;  // no depth is too deep
  for (const double share : {0.3, 0.38, 0.46}) {
    const auto collisions = named(verify(scene, entered_by(0.4 * share), settings), "don't collide");
    ASSERT_EQ(collisions.size(), 1U);
    EXPECT_EQ(collisions[0].holds, share < 0.4) << share << ": " << collisions[0].recomputed;
  }
}

TEST(VerifyFacade, SearchObjectsOfTheirOwnAreLookedAtToo) {
  ReportedResult r = entered_by(-0.1);
  r.search_objects = entered_by(0.1).search_objects;
  const auto collisions = named(verify(block_and_plate(), r, {}), "don't collide");
  ASSERT_EQ(collisions.size(), 2U);
  EXPECT_TRUE(collisions[0].holds);
  EXPECT_FALSE(collisions[1].holds);
}

// Height of the table and of the base, and the turn, by hand.
TEST(VerifyFacade, PosesAreThoseOfTheConventions) {
  ReportedResult r = entered_by(0.0);
  r.objects[0].world_from_model.setIdentity();
  r.objects[0].world_from_model(2, 3) = 0.5;
  r.objects[1].pose.yaw = std::acos(0.0);
  r.objects[1].world_from_model << 0, -1, 0, 0.35, 1, 0, 0, 0, 0, 0, 1, 0.6, 0, 0, 0, 1;
  r.objects[1].camera_from_model << 0, -1, 0, 0.35, -1, 0, 0, 0, 0, 0, -1, 1.9, 0, 0, 0, 1;
  const auto matrices = named(verify(block_and_plate(), r, {}), "_from_model");
  ASSERT_EQ(matrices.size(), 4U);
  EXPECT_TRUE(matrices[0].holds) << matrices[0].recomputed;
  EXPECT_FALSE(matrices[1].holds);
  EXPECT_TRUE(matrices[2].holds) << matrices[2].recomputed;
  EXPECT_TRUE(matrices[3].holds) << matrices[3].recomputed;
}

TEST(VerifyFacade, AbsentObjectsAreNotPlaced) {
  ReportedResult r = entered_by(0.1);
  r.objects[1].absent = true;
  const Checks checks = verify(block_and_plate(), r, {});
  EXPECT_TRUE(named(checks, "objects[1].visible").empty());
  EXPECT_FALSE(named(checks, "objects[0].visible").empty());
}

// A search that leaves all optional objects out has a scene: an empty one, which explains nothing.
TEST(VerifyFacade, AnEmptySceneCostsAllThatWasObserved) {
  Scene scene = block_and_plate();
  for (SceneObject& object : scene.objects) object.optional = true;
  ReportedResult r = entered_by(0.0);
  r.objects[0].absent = r.objects[1].absent = true;
  r.search_objects.clear();
  r.status = Status::solved;
  r.cost = r.cost_observed = r.search_cost = r.lower_bound = 1;
  r.cost_rendered = 0;
  r.suboptimality_bound = 1.0;
  for (const Check& check : verify(scene, r, {}))
    EXPECT_TRUE(check.holds) << check.name << " " << check.recomputed;
  r.cost.reset();  // says less than it should, but must not be trusted to say more
  r.search_cost = 2;
  const Checks checks = verify(scene, r, {});
  EXPECT_EQ(named(checks, "search_cost").back().recomputed, "1");
  EXPECT_FALSE(named(checks, "search_cost").back().holds);
}

TEST(VerifyFacade, MoreObjectsThanTheSceneHasAreNotLookedAt) {
  ReportedResult r = entered_by(0.0);
  r.objects.resize(1000, r.objects[0]);
  r.search_objects.resize(1000, r.search_objects[0]);
  const Checks checks = verify(block_and_plate(), r, {});
  EXPECT_TRUE(named(checks, "collide").empty());
  EXPECT_FALSE(named(checks, "objects, how many").front().holds);
  EXPECT_FALSE(named(checks, "search_objects: block").front().holds);
}

TEST(VerifyFacade, TheSettingsAreThoseStated) {
  Guarantee guarantee;
  guarantee.delta = 0.004;
  guarantee.missing_depth = "ignore";
  guarantee.collision_penetration = 0.02;
  guarantee.collision_overlap = 0.5;
  const Settings settings = stated_settings(guarantee);
  EXPECT_EQ(settings.candidates.cost.delta, 0.004);
  EXPECT_EQ(settings.candidates.cost.missing_depth, MissingDepth::ignore);
  EXPECT_EQ(settings.candidates.collision.penetration, 0.02);
  EXPECT_EQ(settings.candidates.collision.overlap, 0.5);
  guarantee.delta = 0.0;
  EXPECT_THROW(stated_settings(guarantee), InvalidSetting);
}

TEST(VerifyFacade, SomethingMustHaveBeenObserved) {
  Scene scene = block_and_plate();
  scene.depth(10, 10) = 0.0F;
  EXPECT_THROW(verify(scene, entered_by(0.0), {}), InputError);
}

}  // namespace
}  // namespace perch
