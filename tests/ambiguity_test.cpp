// Runner-ups against brute force over all candidates, and confidence in scenes made ambiguous on purpose.

#include "perch/localize/ambiguity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cancelling_executor.hpp"
#include "finish_test_support.hpp"
#include "perch/localize/polish.hpp"

namespace perch {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// Judges a scene as the program does after its search.
JudgedScene judged(FinishProblem& p, const ArrangedScene& scene, const AmbiguitySettings& settings = {},
                   const PolishSettings& polish_settings = {}) {
  if (!p.candidates) p.make_candidates();
  return judge(*p.problem, *p.candidates, p.makers, p.executor, scene, settings, polish_settings,
               StopCondition());
}

/// J of a scene with one object moved, by a count of its own; empty where it would collide or lie outside.
std::optional<std::int64_t> cost_with(FinishProblem& p, std::vector<PlacedModel> placed, std::size_t place,
                                      const Pose& pose) {
  placed[place].pose = pose;
  const Workspace& w = p.problem->workspace(placed[place].model);
  if (pose.x < w.x_min || pose.x > w.x_max || pose.y < w.y_min || pose.y > w.y_max ||
      !p.collision_free(placed))
    return std::nullopt;
  return p.arranged(std::move(placed)).cost;
}

bool elsewhere(const Symmetry& symmetry, const Pose& a, const Pose& b, const AmbiguitySettings& settings) {
  return std::hypot(a.x - b.x, a.y - b.y) > settings.distance ||
         symmetry.yaw_difference(a.yaw, b.yaw) > settings.yaw;
}

TEST(AmbiguityHeavy, RunnerUpIsThatOfBruteForce) {
  AmbiguitySettings settings;
  settings.descents = 0;
  settings.trials = 100000;
  PolishSettings no_exchange;
  no_exchange.rounds = 0;
  int from_set = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    TabletopOptions options = small_view(3, seed % 2 == 0);
    if (seed == 5) options.models = {"can", "mug"};  // copies
    FinishProblem p(random_tabletop(seed, options).scene);
    const ArrangedScene truth = p.truth();
    // With every third candidate valued, then with all.
    p.refine_candidates();
    std::vector<std::size_t> third;
    for (std::size_t i = 0; i < p.candidates->open().size(); i += 3) third.push_back(i);
    p.candidates->value(third, StopCondition());
    const JudgedScene open = judged(p, truth, settings, no_exchange);
    ASSERT_EQ(open.objects.size(), 3U);
    p.candidates->value_all(StopCondition());
    const JudgedScene result = judged(p, truth, settings, no_exchange);
    ASSERT_TRUE(same(result.scene, truth));
    ASSERT_EQ(result.objects.size(), 3U);
    // A set of which the search has dropped most: all of it still counts.
    p.set().restrict_to(std::vector<char>(p.set().size(), 0));
    const JudgedScene restricted = judged(p, truth, settings, no_exchange);
    for (std::size_t place = 0; place < 3; ++place) {
      SCOPED_TRACE(testing::Message() << "object " << place);
      const PlacedModel& object = truth.placed[place];
      const Symmetry& symmetry = p.scene.models[object.model].symmetry;
      std::optional<std::int64_t> least, least_in_set;
      const auto try_pose = [&](const Pose& pose, bool in_set) {
        if (!elsewhere(symmetry, pose, object.pose, settings)) return;
        const auto cost = cost_with(p, truth.placed, place, pose);
        if (cost && (!least || *cost < *least)) least = cost;
        if (cost && in_set && (!least_in_set || *cost < *least_in_set)) least_in_set = cost;
      };
      for (CandidateId id = 0; id < p.set().size(); ++id)
        if (p.set()[id].model == object.model) try_pose(p.set()[id].pose, true);
      const double shift = settings.distance * (1 + 1e-6), turn = settings.yaw * (1 + 1e-6);
      for (int k = 0; k < 8; ++k)
        try_pose({object.pose.x + shift * std::cos(k * 45 * degree),
                  object.pose.y + shift * std::sin(k * 45 * degree), object.pose.yaw},
                 false);
      for (const double way : {turn, -turn})
        try_pose({object.pose.x, object.pose.y, symmetry.canonical_yaw(object.pose.yaw + way)}, false);
      const auto& runner_up = result.objects[place].runner_up;
      ASSERT_TRUE(least && least_in_set && runner_up);
      EXPECT_EQ(runner_up->cost_increase, *least - truth.cost);
      EXPECT_TRUE(elsewhere(symmetry, runner_up->pose, object.pose, settings));
      EXPECT_EQ(cost_with(p, truth.placed, place, runner_up->pose), *least);
      EXPECT_EQ(restricted.objects[place].runner_up->cost_increase, runner_up->cost_increase);
      EXPECT_EQ(open.objects[place].runner_up->cost_increase, runner_up->cost_increase);
      from_set += *least_in_set == *least;
      std::vector<PlacedModel> others = truth.placed;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(place));
      EXPECT_EQ(result.objects[place].support, p.brute_force_cost(others) - truth.cost);
    }
  }
  EXPECT_GT(from_set, 3);
}

TEST(AmbiguityHeavy, MovingRunnerUpsDownhillOnlyHelpsThem) {
  int cheaper = 0;
  for (std::uint64_t seed = 11; seed <= 13; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    TabletopOptions options = small_view(3, true);
    options.models = {"mug", "spray_bottle", "jug", "tea_box"};
    FinishProblem p(random_tabletop(seed, options).scene);
    const ArrangedScene truth = p.truth();
    AmbiguitySettings settings;
    PolishSettings no_exchange;
    no_exchange.rounds = 0;
    const JudgedScene moved = judged(p, truth, settings, no_exchange);
    settings.descents = 0;
    const JudgedScene as_found = judged(p, truth, settings, no_exchange);
    for (std::size_t place = 0; place < 3; ++place) {
      const auto &a = moved.objects[place].runner_up, &b = as_found.objects[place].runner_up;
      ASSERT_TRUE(a && b);
      EXPECT_LE(a->cost_increase, b->cost_increase);
      EXPECT_TRUE(elsewhere(p.scene.models[truth.placed[place].model].symmetry, a->pose,
                            truth.placed[place].pose, settings));
      EXPECT_EQ(cost_with(p, truth.placed, place, a->pose), truth.cost + a->cost_increase);
      cheaper += a->cost_increase < b->cost_increase;
    }
  }
  EXPECT_GT(cheaper, 2);
}

TEST(AmbiguityHeavy, ClearlyVisibleObjectsAreSure) {
  FinishProblem p(staged({household_model("drill"), household_model("can"), household_model("jug")},
                         {{0, {-0.12, -0.03, 0.4}}, {1, {0.0, 0.02, 0.0}}, {2, {0.13, -0.02, 0.3}}}));
  const JudgedScene result = judged(p, p.truth());
  ASSERT_EQ(result.objects.size(), 3U);
  for (const ObjectJudgement& object : result.objects) {
    EXPECT_GT(object.confidence, 0.8);
    EXPECT_LE(object.confidence, 1.0);
    EXPECT_GT(object.runner_up->cost_increase, 0);
  }
}

TEST(AmbiguityHeavy, AMugWhoseHandleIsHiddenIsUnsure) {
  const auto confidence_at = [](double yaw) {
    FinishProblem p(staged({household_model("mug"), household_model("can")},
                           {{0, {-0.05, 0.0, yaw * degree}}, {1, {0.1, 0.02, 0.0}}}));
    const JudgedScene result = judged(p, p.truth());
    EXPECT_GT(result.objects.at(1).confidence, 0.8) << "the can beside it";
    return result.objects.at(0).confidence;
  };
  EXPECT_LT(confidence_at(90.0), 0.5) << "the handle points away from the camera";
  EXPECT_GT(confidence_at(0.0), 0.8) << "sideways";
  EXPECT_GT(confidence_at(-60.0), 0.8) << "to the camera";
}

TEST(Ambiguity, ASquareBoxIsUnsureUnlessItsSymmetryIsTold) {
  SceneModel box = household_model("tea_box");
  ASSERT_EQ(box.symmetry, Symmetry::n_fold(4));
  FinishProblem told(staged({box}, {{0, {0.02, 0.0, 0.3}}}));
  EXPECT_GT(judged(told, told.truth()).objects.at(0).confidence, 0.8);

  box.symmetry = Symmetry::none();
  FinishProblem untold(staged({box}, {{0, {0.02, 0.0, 0.3}}}));
  const ObjectJudgement object = judged(untold, untold.truth()).objects.at(0);
  EXPECT_LT(object.confidence, 0.1);
  ASSERT_TRUE(object.runner_up);
  EXPECT_LE(object.runner_up->cost_increase, 3);
  EXPECT_LT(Symmetry::n_fold(4).yaw_difference(object.runner_up->pose.yaw, 0.3), 3.0 * degree);
  EXPECT_GT(Symmetry::none().yaw_difference(object.runner_up->pose.yaw, 0.3), 80.0 * degree);
}

TEST(Ambiguity, AnObjectThatIsNotThereIsUnsure) {
  Scene scene = staged({household_model("carton"), household_model("can"), household_model("mug")},
                       {{0, {-0.06, 0.0, 0.2}}, {1, {0.1, 0.0, 0.0}}});
  scene.objects.push_back(2);
  FinishProblem p(scene);
  p.make_candidates();
  // Where it costs least: behind the others, or where it is least in the way.
  ArrangedScene best;
  std::vector<PlacedModel> placed = p.truth().placed;
  placed.push_back({2, {}});
  for (CandidateId id = 0; id < p.set().size(); ++id) {
    if (p.set()[id].model != 2) continue;
    const auto cost = cost_with(p, placed, 2, p.set()[id].pose);
    if (!cost || (!best.placed.empty() && *cost >= best.cost)) continue;
    best = {placed, *cost};
    best.placed[2].pose = p.set()[id].pose;
  }
  ASSERT_FALSE(best.placed.empty());
  const JudgedScene result = judged(p, best);
  EXPECT_LT(result.objects.at(2).confidence, 0.1);
  EXPECT_GT(result.objects.at(0).confidence, 0.8);
  EXPECT_GT(result.objects.at(1).confidence, 0.8);
}

TEST(Ambiguity, AnotherCopyIsNoRunnerUp) {
  const SceneModel can = household_model("can");
  FinishProblem p(staged({can}, {{0, {-0.08, 0.0, 0.0}}, {0, {0.08, 0.03, 0.0}}}));
  const JudgedScene result = judged(p, p.truth());
  for (std::size_t place = 0; place < 2; ++place) {
    const auto& runner_up = result.objects.at(place).runner_up;
    ASSERT_TRUE(runner_up);
    const Pose& other = result.scene.placed[1 - place].pose;
    EXPECT_GT(std::hypot(runner_up->pose.x - other.x, runner_up->pose.y - other.y), 0.05);
    EXPECT_GT(result.objects[place].confidence, 0.8);
  }
}

TEST(Ambiguity, WithoutAnotherPoseThereIsNoRunnerUp) {
  Scene scene = staged({household_model("can")}, {{0, {0.0, 0.0, 0.0}}});
  scene.workspace = Workspace{-0.004, 0.004, -0.004, 0.004};
  FinishProblem p(scene);
  const ObjectJudgement object = judged(p, p.truth()).objects.at(0);
  EXPECT_FALSE(object.runner_up);
  EXPECT_EQ(object.confidence, 1.0);
}

TEST(Ambiguity, ABetterRunnerUpTakesThePlaceOfTheAnswer) {
  FinishProblem p(staged({household_model("jug"), household_model("can")},
                         {{0, {-0.06, 0.0, 0.5}}, {1, {0.12, 0.02, 0.0}}}));
  ArrangedScene wrong = p.truth();
  wrong.placed[0].pose.yaw = p.scene.models[0].symmetry.canonical_yaw(0.5 + std::numbers::pi);
  wrong = p.arranged(wrong.placed);
  const JudgedScene result = judged(p, wrong);
  p.expect_valid(result.scene);
  EXPECT_LT(result.scene.cost, wrong.cost / 10);
  EXPECT_LT(Symmetry::none().yaw_difference(result.scene.placed[0].pose.yaw, 0.5), 3.0 * degree);
  EXPECT_GT(result.objects.at(0).confidence, 0.8);

  PolishSettings no_exchange;
  no_exchange.rounds = 0;
  const JudgedScene kept = judged(p, wrong, {}, no_exchange);
  EXPECT_TRUE(same(kept.scene, wrong)) << "without a polish the search's answer stays";
  EXPECT_LT(kept.objects.at(0).runner_up->cost_increase, 0);
  EXPECT_EQ(kept.objects.at(0).confidence, 0.0);
}

TEST(Ambiguity, IsTheSameOnAnyNumberOfThreads) {
  FinishProblem p(random_tabletop(21, small_view(3, true)).scene);
  const JudgedScene one = judged(p, p.truth());
  for (const std::size_t threads : {2, 4}) {
    const auto executor = make_executor(threads);
    auto makers = make_makers(*p.problem, *executor);
    const JudgedScene many =
        judge(*p.problem, *p.candidates, makers, *executor, p.truth(), {}, PolishSettings(), StopCondition());
    EXPECT_TRUE(same(one.scene, many.scene));
    ASSERT_EQ(one.objects.size(), many.objects.size());
    for (std::size_t i = 0; i < one.objects.size(); ++i) {
      EXPECT_EQ(one.objects[i].confidence, many.objects[i].confidence);
      EXPECT_EQ(one.objects[i].support, many.objects[i].support);
      EXPECT_TRUE(one.objects[i].runner_up->pose == many.objects[i].runner_up->pose);
      EXPECT_EQ(one.objects[i].runner_up->cost_increase, many.objects[i].runner_up->cost_increase);
    }
  }
}

TEST(Ambiguity, StopsAtOnce) {
  FinishProblem p(random_tabletop(31, small_view(3, true)).scene);
  p.make_candidates();
  const ArrangedScene truth = p.truth();
  int unfinished = 0;
  for (const std::int64_t bodies : {0, 1, 12, 40, 100}) {
    StopCondition stop;
    const CancellingExecutor executor(stop, bodies);
    const JudgedScene result =
        judge(*p.problem, *p.candidates, p.makers, executor, truth, {}, PolishSettings(), stop);
    EXPECT_LE(executor.after(), 1);
    EXPECT_LE(result.scene.cost, truth.cost);
    p.expect_valid(result.scene);
    if (stop.cancelled()) {
      ++unfinished;
      EXPECT_TRUE(result.objects.empty());
    }
  }
  EXPECT_GT(unfinished, 2);
  AmbiguitySettings off;
  off.trials = 0;
  EXPECT_TRUE(judged(p, truth, off).objects.empty());
}

TEST(Ambiguity, ConfidenceGrowsWithSupportAndMargin) {
  EXPECT_EQ(confidence(1000, 0, 100), 0.0);
  EXPECT_EQ(confidence(1000, -50, std::nullopt), 0.0);
  EXPECT_EQ(confidence(1000, 900, 0), 0.0);
  EXPECT_EQ(confidence(1000, 900, -3), 0.0);
  EXPECT_EQ(confidence(1000, 900, std::nullopt), 1.0);
  EXPECT_GT(confidence(1000, 900, 100), 0.99);
  EXPECT_DOUBLE_EQ(confidence(1000, 900, 15), 1.0 - std::exp(-1.0)) << "half a root of 900";
  EXPECT_LT(confidence(3, 3, 3), 0.1) << "three points are no evidence";
  double last = 0.0;
  for (const std::int64_t support : {10, 100, 300, 500, 560}) {
    const double now = confidence(1000, support, 10 * support);
    EXPECT_GT(now, last);
    last = now;
  }
  last = 0.0;
  for (const std::int64_t increase : {1, 3, 10, 30, 100}) {
    const double now = confidence(1000, 900, increase);
    EXPECT_GT(now, last);
    EXPECT_LE(now, 1.0);
    last = now;
  }
}

}  // namespace
}  // namespace perch
