// Models that may rest in several ways: what each search answers, against every way to give each object a
// body of its own, solved apart as a scene whose models rest in one way.

#include <gtest/gtest.h>

#include <fmt/format.h>

#include "perch/localize/localize.hpp"
#include "perch/sim/parametric_models.hpp"
#include "small_problem.hpp"

namespace perch {
namespace {

/// The scene with each object of a model of its own, which is one given body.
Scene with_bodies(const Scene& scene, const std::vector<std::size_t>& bodies) {
  Scene apart = scene;
  apart.models.clear();
  apart.truth.clear();
  apart.priors.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    SceneModel model = scene.models[bodies[i]];
    model.name = fmt::format("{}", i);
    model.rest_pose = 0;
    apart.models.push_back(std::move(model));
    apart.objects[i].model = i;
  }
  return apart;
}

/// Calls `visit` with every choice of a body for each object.
template <typename Visit>
void for_each_choice(const Scene& scene, Visit visit) {
  std::vector<std::size_t> bodies;
  const auto choose = [&](const auto& self) -> void {
    if (bodies.size() == scene.objects.size()) return visit(bodies);
    const std::size_t first = scene.objects[bodies.size()].model;
    for (std::size_t i = 0; i < rest_pose_count(scene.models, first); ++i) {
      bodies.push_back(first + i);
      self(self);
      bodies.pop_back();
    }
  };
  choose(choose);
}

Result localize_with(const Scene& scene, Settings settings, SearchMethod method, bool exhaustive) {
  settings.method = method;
  settings.exhaustive = exhaustive;
  settings.w = 1.0;
  return localize(scene, settings, SerialExecutor(), StopCondition());
}

std::size_t body_of(const Scene& scene, const ResultPose& object) {
  for (std::size_t m = 0; m < scene.models.size(); ++m)
    if (scene.models[m].name == object.model && scene.models[m].rest_pose == object.rest_pose.value_or(0))
      return m;
  throw std::logic_error("no such body");
}

/// What is answered costs what it says, and says of each object how it rests where its model leaves a choice.
void expect_scored(const Scene& scene, const Settings& settings, const Result& result) {
  std::vector<PlacedModel> placed;
  for (const ResultPose& object : result.search_objects) {
    placed.push_back({body_of(scene, object), object.pose});
    EXPECT_EQ(object.rest_pose.has_value(), rest_pose_count(scene.models, placed.back().model) > 1);
  }
  const ScoreRecord record = score(scene, {placed}, settings, SerialExecutor()).front();
  EXPECT_EQ(record.cost.cost, *result.search_cost);
  EXPECT_FALSE(record.collides);
}

TEST(RestPosesHeavy, EverySearchFindsTheBestOfAllBodies) {
  int lying = 0, choices = 0, cheaper = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const bool repeats = seed % 3 == 0, optional = seed % 4 == 0;
    Scene scene = with_rest_poses(small_tabletop(seed, false, 2, repeats, optional), 1000 + seed).scene;
    const Settings settings = small_settings(seed % 4 < 2 ? RefineMethod::icp : RefineMethod::none);
    const auto method = seed % 2 == 0 ? SearchMethod::branch_and_bound : SearchMethod::focal_mha;
    std::int64_t best = none, first = none;
    for_each_choice(scene, [&](const std::vector<std::size_t>& bodies) {
      const Result apart = localize_with(with_bodies(scene, bodies), settings, method, false);
      best = std::min(best, apart.search_cost.value_or(none));
      if (first == none) first = best;
      ++choices;
    });
    cheaper += best < first;
    const auto check = [&](const Result& result) {
      ASSERT_EQ(result.search_cost.value_or(none), best);
      if (best == none) return;
      EXPECT_EQ(result.lower_bound, best);
      expect_scored(scene, settings, result);
      for (const ResultPose& object : result.search_objects) lying += object.rest_pose.value_or(0) > 0;
    };
    check(localize_with(scene, settings, method, false));
    check(localize_with(scene, settings, method, true));
    // Guided by what is right, or wrong in how it rests.
    for (const TruthPose& truth : scene.truth)
      scene.priors.push_back({seed % 4 < 2 ? truth.model : scene.kind(truth.model), truth.pose});
    check(localize_with(scene, settings, method, false));
  }
  std::printf(
      "%d choices of bodies; in %d of 5 scenes the first is not the best; %d objects not in the first\n",
      choices, cheaper, lying);
  EXPECT_GT(cheaper, 1);
  EXPECT_GT(lying, 6);
}

// Refined in the context of parent scenes, an object may rest in every way too.
TEST(RestPosesHeavy, InContextCostsAreThoseOfTheBodies) {
  const SimulatedScene made = with_rest_poses(small_tabletop(1, false, 2, false), 1001);
  Settings settings = small_settings(RefineMethod::icp);
  settings.mode = CandidateMode::context;
  settings.max_expansions = 8;
  const Result result = localize_with(made.scene, settings, SearchMethod::focal_mha, false);
  ASSERT_TRUE(result.search_cost);
  expect_scored(made.scene, settings, result);
}

SceneLayout layout_of(const std::vector<SceneModel>& models, const std::vector<PlacedModel>& objects) {
  const Intrinsics intrinsics{320, 240, 262.5, 262.5, 159.5, 119.5};
  return {"staged",
          camera_looking_at(intrinsics, {0.0, -0.6, 0.5}, {0.0, 0.0, 0.03}),
          models,
          objects,
          {-0.16, 0.16, -0.12, 0.12}};
}

void append(std::vector<SceneModel>& models, const char* name, const std::vector<Eigen::Vector3d>& ups) {
  for (SceneModel& body : bodies_of(household_model(name), ups)) models.push_back(std::move(body));
}

const Eigen::Vector3d up_x = Eigen::Vector3d::UnitX(), up_y = Eigen::Vector3d::UnitY(),
                      up_z = Eigen::Vector3d::UnitZ();

// Two copies of one model, one upright and one lying, and another model that lies.
TEST(RestPosesHeavy, CopiesAreFoundInDifferentOrientations) {
  std::vector<SceneModel> models;
  append(models, "jug", {up_z, up_y});
  append(models, "mug", {up_x, up_z, -up_z});
  const std::vector<PlacedModel> truth{
      {0, {-0.1, -0.02, 0.5}}, {1, {0.08, -0.09, 0.3}}, {4, {-0.03, 0.1, -0.6}}};
  const SimulatedScene made = simulate(layout_of(models, truth), DepthSensorSettings::clean(), 1);
  ASSERT_EQ(made.scene.objects, (std::vector<SceneObject>{0, 0, 2}));
  const Result result = localize(made.scene, Settings(), SerialExecutor(), StopCondition());
  ASSERT_EQ(result.status, Status::solved);
  const ScoreRecord true_record = score(made.scene, {truth}, Settings(), SerialExecutor()).front();
  EXPECT_LE(result.cost->cost, true_record.cost.cost + 5);
  ASSERT_EQ(result.objects.size(), 3U);
  for (const PlacedModel& object : truth) {
    const SceneModel& body = made.scene.models[object.model];
    const Eigen::Isometry3d expected = world_from_model(object.pose, 0.0) * body.stood_from_model;
    const bool found = std::any_of(result.objects.begin(), result.objects.end(), [&](const ObjectResult& o) {
      return o.model == body.name && o.rest_pose == body.rest_pose &&
             std::hypot(o.pose.x - object.pose.x, o.pose.y - object.pose.y) < 0.003 &&
             body.symmetry.yaw_difference(o.pose.yaw, object.pose.yaw) < 0.03 &&
             (o.world_from_model.matrix() - expected.matrix()).cwiseAbs().maxCoeff() < 0.03;
    });
    EXPECT_TRUE(found) << body.name << ", rest pose " << body.rest_pose;
  }
}

// Lying on either side of the same box is one to the camera: the other is the runner-up, and costs no more.
TEST(RestPosesHeavy, TheRunnerUpMayRestInAnotherWay) {
  std::vector<SceneModel> models;
  append(models, "tea_box", {up_z, -up_z});
  append(models, "can", {up_z});
  const std::vector<PlacedModel> truth{{0, {-0.08, 0.0, 0.5}}, {2, {0.08, -0.02, 0.0}}};
  const SimulatedScene made = simulate(layout_of(models, truth), DepthSensorSettings::clean(), 1);
  const Result result = localize(made.scene, Settings(), SerialExecutor(), StopCondition());
  ASSERT_TRUE(result.cost);
  const ObjectResult &box = result.objects.at(0), &can = result.objects.at(1);
  ASSERT_TRUE(box.runner_up && box.confidence && can.runner_up && can.confidence);
  ASSERT_TRUE(box.rest_pose && box.runner_up->rest_pose);
  EXPECT_NE(*box.rest_pose, *box.runner_up->rest_pose);
  EXPECT_LT(*box.confidence, 0.5);
  EXPECT_GT(*can.confidence, 0.8);
  EXPECT_FALSE(can.rest_pose || can.runner_up->rest_pose);
  std::vector<PlacedModel> other{{static_cast<std::size_t>(*box.runner_up->rest_pose), box.runner_up->pose},
                                 {2, can.pose}};
  EXPECT_EQ(score(made.scene, {other}, Settings(), SerialExecutor()).front().cost.cost,
            result.cost->cost + box.runner_up->cost_increase);
}

}  // namespace
}  // namespace perch
