// The polish against truth and brute force, on simulated scenes.

#include "perch/localize/polish.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "cancelling_executor.hpp"
#include "finish_test_support.hpp"
#include "perch/candidates/candidate_floor.hpp"
#include "perch/core/random.hpp"
#include "perch/localize/pose_descent.hpp"

namespace perch {
namespace {

/// Mean distance of the objects from their true poses, metres; what a turn does at the model's radius counts.
double error(const FinishProblem& p, const ArrangedScene& scene) {
  double sum = 0.0;
  for (std::size_t i = 0; i < scene.placed.size(); ++i) {
    const Pose &pose = scene.placed[i].pose, &truth = p.scene.truth[i].pose;
    const ObjectModel& model = p.problem->models()[scene.placed[i].model];
    sum += std::hypot(pose.x - truth.x, pose.y - truth.y) +
           model.radius() * model.symmetry().yaw_difference(pose.yaw, truth.yaw);
  }
  return sum / static_cast<double>(scene.placed.size());
}

/// The true scene with every object pushed by up to this much; free of collisions.
ArrangedScene displaced(const FinishProblem& p, Random& random, double metres, double radians) {
  while (true) {
    std::vector<PlacedModel> placed;
    for (const TruthPose& t : p.scene.truth) {
      const Symmetry& symmetry = p.scene.models[t.model].symmetry;
      placed.push_back(
          {t.model,
           {t.pose.x + random.uniform(-metres, metres), t.pose.y + random.uniform(-metres, metres),
            symmetry.canonical_yaw(t.pose.yaw + random.uniform(-radians, radians))}});
    }
    if (p.collision_free(placed)) return p.arranged(std::move(placed));
  }
}

TEST(PolishHeavy, BringsADisplacedSceneBack) {
  int lower = 0, nearer = 0, scenes = 0;
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    FinishProblem p(random_tabletop(seed, small_view(3, seed % 3 == 0)).scene);
    Random random(seed);
    const ArrangedScene start = displaced(p, random, 0.006, 0.1);
    const ArrangedScene end =
        polish(*p.problem, p.makers, p.executor, start, PolishSettings(), StopCondition());
    EXPECT_LE(end.cost, start.cost);
    p.expect_valid(end);
    ++scenes;
    lower += end.cost < start.cost;
    nearer += error(p, end) < 0.5 * error(p, start);
  }
  EXPECT_GE(lower, scenes - 1);
  EXPECT_GE(nearer, scenes - 2) << "of " << scenes;
}

TEST(PolishHeavy, WithTheCostAloneItFallsAtLeastAsFar) {
  std::int64_t with_residual = 0, alone = 0;
  for (std::uint64_t seed = 21; seed <= 24; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    FinishProblem p(random_tabletop(seed, small_view(3, true)).scene);
    Random random(seed);
    const ArrangedScene start = displaced(p, random, 0.004, 0.05);
    PolishSettings settings;
    with_residual += polish(*p.problem, p.makers, p.executor, start, settings, StopCondition()).cost;
    settings.descent.residual_weight = 0.0;
    const ArrangedScene end = polish(*p.problem, p.makers, p.executor, start, settings, StopCondition());
    p.expect_valid(end);
    alone += end.cost;
  }
  EXPECT_LE(alone, with_residual);
}

TEST(Polish, IsTheSameOnAnyNumberOfThreads) {
  FinishProblem p(random_tabletop(31, small_view(4, true)).scene);
  Random random(31);
  const ArrangedScene start = displaced(p, random, 0.006, 0.1);
  const ArrangedScene end =
      polish(*p.problem, p.makers, p.executor, start, PolishSettings(), StopCondition());
  EXPECT_LT(end.cost, start.cost);
  for (const std::size_t threads : {2, 4}) {
    const auto executor = make_executor(threads);
    auto makers = make_makers(*p.problem, *executor);
    EXPECT_TRUE(same(end, polish(*p.problem, makers, *executor, start, PolishSettings(), StopCondition())))
        << threads << " threads";
  }
}

TEST(Polish, StopsAtOnceWithTheBestSoFar) {
  FinishProblem p(random_tabletop(41, small_view(3, false)).scene);
  Random random(41);
  const ArrangedScene start = displaced(p, random, 0.006, 0.1);
  std::vector<std::int64_t> costs;
  for (const std::int64_t bodies : {0, 5, 30, 60, 100000}) {
    SCOPED_TRACE(testing::Message() << bodies << " trials");
    StopCondition stop;
    const CancellingExecutor executor(stop, bodies);
    const ArrangedScene end = polish(*p.problem, p.makers, executor, start, PolishSettings(), stop);
    EXPECT_LE(executor.after(), 1);
    p.expect_valid(end);
    costs.push_back(end.cost);
  }
  EXPECT_LE(costs.front(), start.cost);
  EXPECT_TRUE(std::is_sorted(costs.rbegin(), costs.rend())) << "more trials never cost more";
  EXPECT_LT(costs[3], start.cost) << "what was reached before the stop is kept";

  StopCondition cancelled;
  cancelled.cancel();
  EXPECT_TRUE(same(start, polish(*p.problem, p.makers, p.executor, start, PolishSettings(), cancelled)));
  EXPECT_TRUE(
      same(start, polish_best(*p.problem, p.makers, p.executor, {start}, PolishSettings(), cancelled)));
}

TEST(Polish, KeepsToItsTrials) {
  FinishProblem p(random_tabletop(42, small_view(3, false)).scene);
  Random random(42);
  const ArrangedScene start = displaced(p, random, 0.006, 0.1);
  PolishSettings settings;
  for (const int trials : {1, 10, 40, 150}) {
    settings.trials = trials;
    StopCondition stop;
    // Each object is drawn once before it moves, and once after each of its moves: one in a round.
    const int drawings = 3 + 3 * settings.rounds;
    const CancellingExecutor executor(stop, 3 * trials + drawings);  // runs no more or is cancelled
    const ArrangedScene end = polish(*p.problem, p.makers, executor, start, settings, stop);
    EXPECT_FALSE(stop.cancelled()) << trials;
    EXPECT_LE(end.cost, start.cost);
  }
  settings.rounds = 0;
  EXPECT_TRUE(same(start, polish_best(*p.problem, p.makers, p.executor, {start}, settings, StopCondition())));
}

TEST(Polish, WhatCannotGetCheaperStaysAsItIs) {
  int perfect = 0;
  for (std::uint64_t seed = 51; seed <= 54; ++seed) {
    FinishProblem p(random_tabletop(seed, small_view(2, false)).scene);
    const ArrangedScene truth = p.truth();
    if (truth.cost > 0) continue;  // depths are rounded
    ++perfect;
    EXPECT_TRUE(
        same(truth, polish(*p.problem, p.makers, p.executor, truth, PolishSettings(), StopCondition())))
        << "seed " << seed;
  }
  EXPECT_GE(perfect, 2);
}

TEST(Polish, TurnsAnObjectThatFacesTheWrongWay) {
  FinishProblem p(staged({household_model("drill"), household_model("can")},
                         {{0, {-0.06, 0.0, 0.4}}, {1, {0.12, 0.05, 0.0}}}));
  ArrangedScene start = p.truth();
  start.placed[0].pose.yaw = p.scene.models[0].symmetry.canonical_yaw(0.4 + std::numbers::pi);
  start.placed[0].pose.x += 0.004;
  start = p.arranged(start.placed);
  const ArrangedScene end =
      polish(*p.problem, p.makers, p.executor, start, PolishSettings(), StopCondition());
  p.expect_valid(end);
  EXPECT_LT(end.cost, start.cost / 5);
  EXPECT_LT(error(p, end), 0.003);
  PolishSettings settings;
  settings.descent.turns = 0;
  EXPECT_GT(error(p, polish(*p.problem, p.makers, p.executor, start, settings, StopCondition())), 0.1);
}

TEST(Polish, StaysInTheWorkspace) {
  Scene scene = random_tabletop(61, small_view(2, false)).scene;
  // The nearest allowed place of each object is 3 mm from where it is.
  const Pose truth = scene.truth[0].pose;
  scene.objects = {scene.truth[0].model};
  scene.truth.resize(1);
  scene.workspace = Workspace{truth.x - 0.05, truth.x - 0.003, truth.y - 0.05, truth.y + 0.05};
  FinishProblem p(scene);
  const ArrangedScene start =
      p.arranged({{scene.truth[0].model,
                   {truth.x - 0.01, truth.y - 0.004,
                    scene.models[scene.truth[0].model].symmetry.canonical_yaw(truth.yaw)}}});
  const ArrangedScene end =
      polish(*p.problem, p.makers, p.executor, start, PolishSettings(), StopCondition());
  p.expect_valid(end);
  EXPECT_LT(end.cost, start.cost);
}

TEST(Polish, KeepsTheBestOfSeveral) {
  // A mug whose handle is hidden: every yaw costs about the same and leads to another end.
  FinishProblem p(staged({household_model("mug"), household_model("can")},
                         {{0, {-0.05, 0.0, 0.5 * std::numbers::pi}}, {1, {0.1, 0.02, 0.0}}}));
  std::vector<ArrangedScene> starts;
  for (const double turn : {0.0, 0.003, 0.2, -0.2}) {
    ArrangedScene start = p.truth();
    start.placed[0].pose.yaw += turn;
    start.placed[0].pose.x += 0.003;
    start.placed[1].pose.y += 0.004;
    starts.push_back(p.arranged(start.placed));
  }
  std::sort(starts.begin(), starts.end(),
            [](const ArrangedScene& a, const ArrangedScene& b) { return a.cost < b.cost; });
  ASSERT_LE(2 * starts.back().cost, 3 * starts.front().cost) << "all of them near-optimal";
  PolishSettings settings;
  settings.descent.turns = 0;
  std::vector<std::int64_t> ends;
  for (const ArrangedScene& start : starts)
    ends.push_back(polish(*p.problem, p.makers, p.executor, start, settings, StopCondition()).cost);
  const auto best = [&](const std::vector<ArrangedScene>& of) {
    return polish_best(*p.problem, p.makers, p.executor, of, settings, StopCondition());
  };
  settings.scenes = 4;
  const ArrangedScene of_all = best(starts);
  p.expect_valid(of_all);
  // Those that resemble another are left out, and end where that one ends, or nearly.
  EXPECT_GE(of_all.cost, *std::min_element(ends.begin(), ends.end()));
  EXPECT_LE(of_all.cost, *std::min_element(ends.begin(), ends.end()) + 3);
  settings.scenes = 1;
  EXPECT_EQ(best(starts).cost, std::min(ends.front(), starts.front().cost));
  // What costs half as much again is not looked at, however good it would become.
  ArrangedScene dear = starts.back();
  dear.cost = 2 * starts.front().cost;
  settings.scenes = 4;
  EXPECT_EQ(best({starts.front(), dear}).cost, ends.front());
  // Two of the same: the first.
  EXPECT_TRUE(same(best({starts.front()}), best({starts.front(), starts.front()})));
}

TEST(ObjectTrials, CountAsBruteForceDoes) {
  for (std::uint64_t seed = 81; seed <= 83; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    FinishProblem p(random_tabletop(seed, small_view(3, true)).scene);
    Random random(seed);
    const ArrangedScene truth = p.truth();
    const StopCondition stop;
    ObjectTrials trials(*p.problem, p.makers, p.executor, stop);
    SceneDrawings drawings(p.makers, p.executor);
    ASSERT_TRUE(drawings.draw(truth.placed, stop));
    int fits = 0, fails = 0;
    for (std::size_t place = 0; place < 3; ++place) {
      trials.take_out(truth.placed, place, drawings);
      std::vector<PlacedModel> others = truth.placed;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(place));
      EXPECT_EQ(trials.cost_without(), p.brute_force_cost(others));
      std::vector<Trial> batch{{truth.placed[place].pose}};
      for (int i = 0; i < 6; ++i)
        batch.push_back(
            {{random.uniform(-0.25, 0.25), random.uniform(-0.2, 0.2), random.uniform(-4, 4)}, i % 2 == 0});
      std::vector<std::optional<TrialResult>> answers;
      ASSERT_TRUE(trials.run(batch, std::numeric_limits<std::int64_t>::max(), answers));
      for (std::size_t i = 0; i < batch.size(); ++i) {
        std::vector<PlacedModel> scene = truth.placed;
        if (answers[i]) {
          ++fits;
          scene[place].pose = answers[i]->pose;
          p.expect_valid({scene, answers[i]->cost});
        } else if (!batch[i].align) {
          ++fails;
          scene[place].pose = batch[i].pose;
          const Workspace& w = p.problem->workspace(scene[place].model);
          EXPECT_TRUE(!p.collision_free(scene) || batch[i].pose.x < w.x_min || batch[i].pose.x > w.x_max ||
                      batch[i].pose.y < w.y_min || batch[i].pose.y > w.y_max);
        }
      }
    }
    EXPECT_GT(fits, 5);
    EXPECT_GT(fails, 0);
  }
}

TEST(PoseDescent, KeepsToItsRegion) {
  FinishProblem p(random_tabletop(91, small_view(2, false)).scene);
  const ArrangedScene truth = p.truth();
  const StopCondition stop;
  ObjectTrials trials(*p.problem, p.makers, p.executor, stop);
  SceneDrawings drawings(p.makers, p.executor);
  ASSERT_TRUE(drawings.draw(truth.placed, stop));
  trials.take_out(truth.placed, 0, drawings);
  const Pose goal = truth.placed[0].pose;
  const auto start = trials.run_one({goal.x + 0.02, goal.y, goal.yaw});
  ASSERT_TRUE(start);
  const DescentSettings settings;
  PoseDescent descent(trials, settings, 1000);
  const auto far = [&](const Pose& pose) { return pose.x > goal.x + 0.01; };
  const TrialResult kept_out = descent.run(*start, true, far);
  EXPECT_TRUE(far(kept_out.pose));
  EXPECT_LT(kept_out.cost, start->cost);
  const TrialResult free = descent.run(*start, true);
  EXPECT_LT(free.cost, kept_out.cost);
  EXPECT_LT(std::hypot(free.pose.x - goal.x, free.pose.y - goal.y), 0.003);
}

TEST(CandidateFloor, IsNeverAboveTheCost) {
  std::int64_t counted = 0, useful = 0;
  for (std::uint64_t seed = 101; seed <= 103; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    FinishProblem p(random_tabletop(seed, small_view(3, true)).scene);
    p.make_candidates();
    Random random(seed);
    for (int round = 0; round < 4; ++round) {
      // Any composite will do, also of objects that collide.
      Composite others = p.problem->cost().empty();
      CandidateMaker& maker = p.makers.front();
      for (int i = 0; i < round; ++i) {
        const auto id = static_cast<CandidateId>(random.below(p.set().size()));
        p.problem->cost().add(others, maker.patch(p.set()[id]), maker.scratch());
      }
      const CandidateFloor floor_of(p.problem->cost(), others);
      const std::int64_t without = p.problem->cost().counts(others).total();
      for (CandidateId id = 0; id < p.set().size(); id += 7) {
        const std::int64_t cost =
            p.problem->cost().counts_with(others, maker.patch(p.set()[id]), maker.scratch()).total();
        const std::int64_t floor = floor_of(p.set()[id]);
        EXPECT_LE(floor, cost) << id;
        ++counted;
        useful += floor > without - p.set()[id].points;
      }
    }
  }
  EXPECT_GT(useful, counted / 4) << "better than what the number of its points alone says";
}

}  // namespace
}  // namespace perch
