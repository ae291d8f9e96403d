#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "perch/core/random.hpp"
#include "perch/eval/scene_evaluator.hpp"
#include "perch/eval/summary.hpp"
#include "perch/eval/test_shapes.hpp"
#include "perch/eval/visible_fractions.hpp"
#include "perch/io/test_files.hpp"

// What is recorded of a scene under a method.
namespace perch {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using testing_files::TemporaryDirectory;

/// A camera 1 m above the plane that looks straight down on blocks of 6 x 4 x 5 cm and square ones of 5 x 5 x
/// 5 cm; 320 pixels wide.
Scene scene_of(const std::vector<TruthPose>& truth) {
  Scene scene;
  scene.camera.intrinsics = {320, 240, 300.0, 300.0, 159.5, 119.5};
  scene.camera.world_from_camera.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  scene.camera.world_from_camera.translation() << 0, 0, 1;
  scene.depth = DepthImage(320, 240);
  scene.models = {{"block", testing_eval::box(0.06F, 0.04F, 0.05F), Symmetry::none(), 0.0},
                  {"square", testing_eval::box(0.05F, 0.05F, 0.05F), Symmetry::n_fold(4), 0.0}};
  scene.truth = truth;
  for (const TruthPose& object : truth) scene.objects.emplace_back(object.model);
  return scene;
}

ReportedResult result_of(const std::vector<PlacedModel>& placed) {
  ReportedResult result;
  result.status = Status::solved;
  result.stats.seconds.total = 2.5;
  for (const PlacedModel& object : placed) {
    result.objects.emplace_back();
    result.objects.back().model = object.model;
    result.objects.back().pose = object.pose;
  }
  return result;
}

constexpr double degree = degrees(1.0);

const std::vector<TruthPose> three_blocks{{0, {-0.2, 0.0, 0.1}, Symmetry::none()},
                                          {1, {0.2, 0.0, 0.0}, Symmetry::n_fold(4)},
                                          {0, {0.0, 0.1, -2.0}, Symmetry::none()}};

TEST(SceneEvaluator, InAnotherRestPoseItIsWrongByHowFarTheModelTurned) {
  Scene scene = scene_of({});
  const SceneModel block = scene.models.front();
  scene.models = bodies_of(block, {Eigen::Vector3d::UnitZ(), Eigen::Vector3d(0.0, 0.6, 0.8)});
  const Pose at{0.05, -0.02, 0.3};
  scene.truth = {{1, at, Symmetry::none()}};
  scene.objects = {0};
  const SceneEvaluator evaluator(scene, "s", 0.0);
  const ObjectRecord right = evaluator.evaluate(result_of({{1, at}})).objects.at(0);
  EXPECT_EQ(right.verdict(tightest_threshold), Verdict::within);
  EXPECT_FALSE(right.errors->other_rest_pose);
  const ObjectRecord wrong = evaluator.evaluate(result_of({{0, at}})).objects.at(0);
  ASSERT_TRUE(wrong.errors);
  EXPECT_TRUE(wrong.errors->other_rest_pose);
  EXPECT_EQ(wrong.verdict({1.0, 10.0}), Verdict::missed) << "whatever the threshold";
  EXPECT_EQ(wrong.errors->translation, 0.0);
  // Its vertices, in the model's own frame, are as far apart as the two motions take them.
  const auto world_from_model = [&](std::size_t body) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(Eigen::Vector3d(at.x, at.y, 0.0));
    pose.rotate(Eigen::AngleAxisd(at.yaw, Eigen::Vector3d::UnitZ()));
    return pose * scene.models[body].stood_from_model;
  };
  double sum = 0.0, most = 0.0;
  for (const Eigen::Vector3f& p : block.mesh.vertices) {
    const Eigen::Vector3d v = p.cast<double>();
    const double distance = (world_from_model(0) * v - world_from_model(1) * v).norm();
    sum += distance;
    most = std::max(most, distance);
  }
  EXPECT_NEAR(wrong.errors->add, sum / static_cast<double>(block.mesh.vertices.size()), 1e-7);
  EXPECT_NEAR(wrong.errors->mssd, most, 1e-7);
  EXPECT_GT(most, 0.02);
}

// Of two copies each goes to the truth that rests as it does, though the other lies nearer by a little.
TEST(SceneEvaluator, CopiesAreAssignedByHowTheyRest) {
  Scene scene = scene_of({});
  scene.models = bodies_of(scene.models.front(), {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY()});
  scene.truth = {{0, {0.0, 0.0, 0.0}, Symmetry::none()}, {1, {0.004, 0.0, 0.0}, Symmetry::none()}};
  scene.objects = {0, 0};
  const SceneRecord record =
      SceneEvaluator(scene, "s", 0.0).evaluate(result_of({{1, {0.0, 0.0, 0.0}}, {0, {0.004, 0.0, 0.0}}}));
  for (const ObjectRecord& object : record.objects) EXPECT_FALSE(object.errors->other_rest_pose);
}

TEST(SceneEvaluator, TheTruthIsRightByEveryMetric) {
  const Scene scene = scene_of(three_blocks);
  const SceneRecord record =
      SceneEvaluator(scene, "s", 0.0)
          .evaluate(result_of({{0, three_blocks[2].pose}, {0, three_blocks[0].pose}, {1, {0.2, 0.0, 0.0}}}),
                    [](const auto&) -> std::vector<std::int64_t> { throw std::logic_error("not needed"); });
  ASSERT_THAT(record.objects, SizeIs(3));
  EXPECT_EQ(record.surplus, 0U);
  EXPECT_EQ(record.run->seconds, 2.5);
  for (const ObjectRecord& object : record.objects) {
    ASSERT_TRUE(object.errors);
    for (const double error : {object.errors->translation, object.errors->yaw, object.errors->add,
                               object.errors->add_s, object.errors->mssd, object.errors->mspd})
      EXPECT_NEAR(error, 0.0, 1e-6);
    EXPECT_THAT(object.errors->vsd, testing::Each(0.0));
    EXPECT_EQ(object.visible_fraction, 1.0);
    EXPECT_EQ(object.verdict(tightest_threshold), Verdict::within);
  }
  EXPECT_NEAR(record.objects[1].diameter, 0.05 * std::sqrt(3.0), 1e-8);
  EXPECT_TRUE(record.objects[1].symmetric);
}

TEST(SceneEvaluator, AShiftIsFoundByEveryMetric) {
  const Scene scene = scene_of({{1, {0.0, 0.0, 0.0}, Symmetry::n_fold(4)}});
  const PoseErrors errors = *SceneEvaluator(scene, "s", 0.0)
                                 .evaluate(result_of({{1, {0.03, 0.04, 93.0 * degree}}}))
                                 .objects.at(0)
                                 .errors;
  EXPECT_NEAR(errors.translation, 0.05, 1e-12);
  EXPECT_NEAR(errors.yaw, 3.0 * degree, 1e-12);
  // The top, 0.95 m away, moves by 5 cm and at most the chord of 3 degrees; pixels are those of an image 640
  // wide.
  const double chord = 0.05 * std::sqrt(2.0) * std::sin(1.5 * degree);
  EXPECT_NEAR(errors.mssd, 0.05, chord + 1e-6);
  EXPECT_NEAR(errors.mspd, 2.0 * 300.0 * 0.05 / 0.95, 2.0 * 300.0 * chord / 0.95 + 1e-6);
  EXPECT_GT(errors.vsd[0], 0.5);
}

TEST(SceneEvaluator, HeightsAreThoseOfThePlaneAndTheModel) {
  Scene scene = scene_of({{0, {}, Symmetry::none()}});
  scene.models[0].base = 0.35;  // its top at 0.5 m below a camera at 1 m, with the plane at 0.1 m
  const PoseErrors errors =
      *SceneEvaluator(scene, "s", 0.1).evaluate(result_of({{0, {0.01, 0.0, 0.0}}})).objects.at(0).errors;
  EXPECT_NEAR(errors.mspd, 2.0 * 300.0 * 0.01 / 0.5, 1e-4);
}

// 9 found of which 5 stand in for the 5 true ones: the sum over pairs is the least of all permutations.
TEST(SceneEvaluator, RepeatsAreAssignedAtTheLeastSum) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto anywhere = [&]() -> Pose {
      return {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-3.0, 3.0)};
    };
    std::vector<TruthPose> truth;
    std::vector<PlacedModel> found;
    for (int i = 0; i < 4; ++i) truth.push_back({0, anywhere(), Symmetry::n_fold(2)});
    for (int i = 0; i < 6; ++i) found.push_back({0, anywhere()});
    const Scene scene = scene_of(truth);
    const SceneRecord record = SceneEvaluator(scene, "s", 0.0).evaluate(result_of(found));
    const auto cost = [](double translation, double yaw) {
      return std::min(0.1, translation) + 0.01 * yaw / std::numbers::pi;
    };
    double sum = 0.0;
    for (const ObjectRecord& object : record.objects)
      sum += cost(object.errors->translation, object.errors->yaw);
    std::vector<std::size_t> order(found.size());
    std::iota(order.begin(), order.end(), 0);
    double least = INFINITY;
    do {
      double all = 0.0;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        const Pose& a = truth[i].pose;
        const Pose& b = found[order[i]].pose;
        all += cost(std::hypot(a.x - b.x, a.y - b.y), truth[i].symmetry.yaw_difference(a.yaw, b.yaw));
      }
      least = std::min(least, all);
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_NEAR(sum, least, 1e-12);
    EXPECT_EQ(record.surplus, 2U);
  }
}

TEST(SceneEvaluator, AbsentObjectsAndOtherModelsStandForNone) {
  const Scene scene = scene_of(three_blocks);
  ReportedResult result =
      result_of({{0, three_blocks[0].pose}, {0, three_blocks[2].pose}, {0, {0.2, 0.0, 0.0}}});
  result.objects[1].absent = true;
  const SceneRecord record = SceneEvaluator(scene, "s", 0.0).evaluate(result);
  EXPECT_TRUE(record.objects[0].errors);
  EXPECT_FALSE(record.objects[1].errors);  // a block where the square is
  EXPECT_TRUE(record.objects[2].errors);   // that block stands for this one, though far away
  EXPECT_EQ(record.objects[2].verdict({0.1, 4.0}), Verdict::missed);
  EXPECT_EQ(record.surplus, 0U);
}

TEST(SceneEvaluator, WithoutAResultAllIsMissed) {
  const Scene scene = scene_of(three_blocks);
  const SceneRecord record = SceneEvaluator(scene, "s", 0.0).missing();
  EXPECT_FALSE(record.run);
  ASSERT_THAT(record.objects, SizeIs(3));
  for (const ObjectRecord& object : record.objects) EXPECT_EQ(object.verdict({1.0, 4.0}), Verdict::missed);
}

TEST(SceneEvaluator, IsAmbiguousWhatCostsNoMoreThanTheTruth) {
  const Scene scene = scene_of(three_blocks);
  const Pose turned{-0.2, 0.0, 0.1 + std::numbers::pi};
  std::vector<std::vector<PlacedModel>> asked;
  const auto costs = [&](std::int64_t of_turned, std::int64_t of_far) {
    return [&asked, of_turned, of_far](const std::vector<std::vector<PlacedModel>>& arrangements) {
      asked = arrangements;
      return std::vector<std::int64_t>{100, of_turned, of_far};
    };
  };
  const ReportedResult result = result_of({{0, turned}, {0, {0.0, 0.15, -2.0}}, {1, {0.2, 0.0, 0.0}}});
  const SceneRecord record = SceneEvaluator(scene, "s", 0.0).evaluate(result, costs(100, 101));
  // The truth, and the truth with one object at a time where it was found.
  ASSERT_THAT(asked, ElementsAre(SizeIs(3), SizeIs(3), SizeIs(3)));
  EXPECT_EQ(asked[0][0].pose, three_blocks[0].pose);
  EXPECT_EQ(asked[1][0].pose, turned);
  EXPECT_EQ(asked[1][2].pose, three_blocks[2].pose);
  EXPECT_EQ(asked[2][0].pose, three_blocks[0].pose);
  EXPECT_EQ(asked[2][2].pose.y, 0.15);
  EXPECT_EQ(record.objects[0].verdict(right_threshold), Verdict::ambiguous);
  EXPECT_EQ(record.objects[1].verdict(right_threshold), Verdict::within);
  EXPECT_EQ(record.objects[2].verdict(right_threshold), Verdict::missed);
  EXPECT_EQ(record.objects[0].verdict({0.01, std::numbers::pi}), Verdict::within);  // 180 degrees: any yaw
}

TEST(VisibleFractionsFile, IsReadBesideTheScene) {
  const TemporaryDirectory dir;
  const Scene scene = scene_of(three_blocks);
  const auto read = [&] { return read_visible_fractions(dir.path() / "scene.yaml", scene); };
  EXPECT_EQ(read(), std::nullopt);
  dir.write("truth.json", R"({"names": []})");
  EXPECT_EQ(read(), std::nullopt);
  dir.write("truth.json", R"({"visible": [1, 0.25, 0]})");
  EXPECT_THAT(*read(), ElementsAre(1.0, 0.25, 0.0));
  const std::vector<std::pair<std::string, std::string>> broken{
      {"{", "no JSON"},
      {R"({"visible": 3})", "visible: 3"},
      {R"({"visible": [1, 2, 0]})", "visible[1]: 2 is not from 0 to 1"},
      {R"({"visible": [1, "x", 0]})", "visible[1]"},
      {R"({"visible": [1, 1]})", "visible: has 2 entries, but the scene's truth has 3"}};
  for (const auto& [bytes, words] : broken) {
    dir.write("truth.json", bytes);
    EXPECT_THAT(testing_files::input_error(read), HasSubstr(words)) << bytes;
  }
}

}  // namespace
}  // namespace perch
