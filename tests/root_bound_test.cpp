// Candidates valued only where they could matter: against enumeration of the scenes of all of them.

#include "perch/candidates/root_bound.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <tuple>

#include "perch/core/random.hpp"
#include "perch/localize/localize.hpp"
#include "small_problem.hpp"

namespace perch {
namespace {

constexpr std::int64_t unknown_cost = std::int64_t{1} << 40;

using PoseKey = std::tuple<std::size_t, double, double, double>;

/// J of the best scene of all candidates, and of the best one with each.
struct Best {
  std::int64_t cost = none;
  std::map<PoseKey, std::int64_t> with;
  std::vector<std::int64_t> costs;

  std::int64_t cost_with(const FixedCandidates::Hypothesis& h) const {
    const auto found = with.find({h.model, h.pose.x, h.pose.y, h.pose.yaw});
    return found == with.end() ? none : found->second;
  }
};

Best best_of(SmallProblem& small) {
  Best best;
  small.for_each_scene([&](const std::vector<CandidateId>& placed) {
    if (!small.collision_free(placed)) return;
    const std::int64_t cost = small.flat_cost(placed);
    best.cost = std::min(best.cost, cost);
    best.costs.push_back(cost);
    for (const CandidateId id : placed) {
      const Candidate& c = small.set[id];
      if (c.absent) continue;
      const auto [place, is_new] = best.with.try_emplace({c.model, c.pose.x, c.pose.y, c.pose.yaw}, cost);
      place->second = std::min(place->second, cost);
    }
  });
  return best;
}

/// All candidates of two or three objects; copies, optional objects, clutter and unknown pixels among them.
std::unique_ptr<SmallProblem> problem_of_all(std::uint64_t seed) {
  Random random(seed);
  const int objects = 2 + static_cast<int>(random.below(2));
  SimulatedScene simulated =
      small_tabletop(seed, random.below(2) == 0, objects, random.below(3) == 0, random.below(4) == 0);
  if (random.below(2) == 0) add_mask(simulated.scene, random);
  Settings settings = small_settings(random.below(2) == 0 ? RefineMethod::none : RefineMethod::icp);
  settings.candidates.grid.yaw_resolution = objects == 2 ? 1.6 : 2.0 * std::numbers::pi;
  if (random.below(2) == 0) settings.candidates.cost.missing_depth = MissingDepth::ignore;
  add_clutter(simulated.scene, settings, random);
  return std::make_unique<SmallProblem>(std::move(simulated), settings);
}

/// Values a few at random, and one of each kind.
void value_some(const SmallProblem& small, FixedCandidates& candidates, Random& random) {
  const StopCondition never;
  const double share = random.uniform(0.0, 0.3);
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < candidates.open().size(); ++i)
    if (random.uniform() < share) which.push_back(i);
  ASSERT_TRUE(candidates.value(which, never));
  for (std::size_t kind = 0; kind < small.problem->kinds(); ++kind)
    for (std::size_t i = 0; i < candidates.open().size(); ++i)
      if (small.problem->copies()[kind] > 0 && candidates.set().of_kind(kind).empty() &&
          small.problem->kind_of(candidates.open()[i].model) == kind) {
        ASSERT_TRUE(candidates.value({i}, never));
        i = 0;
      }
}

struct Tally {
  std::size_t hypotheses = 0, left = 0;
  int proven = 0, not_proven = 0, greedy = 0;
};

/// Steps to completion. \param upper_bound at least the cost of the best scene.
void expect_exact(const SmallProblem& small, const Best& best, FixedCandidates& candidates, RootBound& root,
                  std::int64_t upper_bound, double w, Tally& tally) {
  const StopCondition never;
  const double enough = static_cast<double>(upper_bound) / w;
  std::int64_t last = 0;
  for (auto step = RootBound::Step::valued; step == RootBound::Step::valued;) {
    const std::size_t before = candidates.open().size();
    step = root.step(upper_bound, enough, never);
    ASSERT_NE(step, RootBound::Step::interrupted);
    ASSERT_EQ(step == RootBound::Step::valued, candidates.open().size() < before);
    ASSERT_GE(root.lower_bound(), last) << "the bound never falls";
    ASSERT_LE(root.lower_bound(), best.cost);
    last = root.lower_bound();
  }
  tally.hypotheses += small.refined->open().size();
  tally.left += candidates.open().size();
  if (static_cast<double>(last) >= enough) {
    ++tally.proven;
    return;
  }
  ++tally.not_proven;
  for (const FixedCandidates::Hypothesis& hypothesis : candidates.open())
    ASSERT_GE(best.cost_with(hypothesis), upper_bound)
        << "model " << hypothesis.model << " at " << hypothesis.pose.x << ' ' << hypothesis.pose.y << ' '
        << hypothesis.pose.yaw;
  LagrangianBound bound = root.bound();
  bound.improve(static_cast<int>(upper_bound % 7), upper_bound, 1e18, small.executor, never);
  ASSERT_LE(std::min(upper_bound, bound.lower_bound()), best.cost);
}

/// From a few that are valued at random, with any known scene or none.
void check_from_some(SmallProblem& small, const Best& best, Random& random, Tally& tally) {
  std::vector<std::int64_t> upper_bounds{unknown_cost};
  if (best.cost != none)
    upper_bounds.insert(upper_bounds.end(), {best.cost, best.cost + 1, best.cost + 2, best.cost + 5,
                                             best.costs[random.below(best.costs.size())]});
  for (const std::int64_t upper_bound : upper_bounds)
    for (const double w : {1.0, 1.3, 3.0}) {
      SCOPED_TRACE(testing::Message() << "upper bound " << upper_bound << " w " << w);
      FixedCandidates candidates = *small.refined;
      value_some(small, candidates, random);
      RootBound root(*small.problem, candidates, small.executor);
      expect_exact(small, best, candidates, root, upper_bound, w, tally);
      if (testing::Test::HasFatalFailure()) return;
    }
}

/// As the search does it: from the greedy scene on.
void check_from_greedy_scene(SmallProblem& small, const Best& best, double w, Tally& tally) {
  const LocalizationProblem& problem = *small.problem;
  FixedCandidates candidates = *small.refined;
  RootBound root(problem, candidates, small.executor);
  const StopCondition never;
  const auto scene = root.greedy_scene({}, small.makers.front(), never);
  for (std::size_t kind = 0; kind < problem.kinds(); ++kind)
    EXPECT_TRUE(problem.copies()[kind] == 0 || !candidates.set().of_kind(kind).empty());
  if (scene) {
    std::vector<int> copies(problem.kinds(), 0);
    std::vector<CandidateId> placed;
    for (const CandidateId id : scene->candidates) {
      ++copies[candidates.set().kind(id)];
      for (const CandidateId other : placed)
        EXPECT_FALSE(problem.collide(candidates.set()[id], candidates.set()[other]));
      placed.push_back(id);
    }
    EXPECT_EQ(copies, problem.copies());
    EXPECT_TRUE(std::is_sorted(placed.begin(), placed.end()));
    EXPECT_EQ(scene->cost, scene_cost(problem, candidates.set(), placed, small.makers.front()));
    EXPECT_GE(scene->cost, best.cost);
    ASSERT_TRUE(root.value_beside(placed, never));
    ++tally.greedy;
  }
  expect_exact(small, best, candidates, root, scene ? scene->cost : unknown_cost, w, tally);
}

/// The whole method, whatever it did not value.
void check_localize(const SmallProblem& small, const Best& best, double w) {
  Settings settings = small.settings;
  settings.w = w;
  const Result result = localize(small.simulated.scene, settings, small.executor, StopCondition());
  EXPECT_EQ(result.status, best.cost == none ? Status::infeasible : Status::solved);
  ASSERT_EQ(result.search_cost.has_value(), best.cost != none);
  if (best.cost == none) return;
  EXPECT_GE(*result.search_cost, best.cost);
  EXPECT_LE(static_cast<double>(*result.search_cost), w * static_cast<double>(best.cost));
  EXPECT_LE(static_cast<double>(*result.search_cost), w * static_cast<double>(result.lower_bound));
  EXPECT_LE(result.lower_bound, best.cost);
}

// One loop over the problems, since enumerating takes most of the time.
TEST(RootBoundHeavy, WhatIsLeftOpenIsOfNoUse) {
  constexpr int problems = 14;
  Tally tally;
  for (std::uint64_t seed = 1; seed <= problems; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto small = problem_of_all(seed);
    const Best best = best_of(*small);
    Random random(seed);
    check_from_some(*small, best, random, tally);
    check_from_greedy_scene(*small, best, seed % 2 == 0 ? 1.0 : 1.5, tally);
    check_localize(*small, best, seed % 3 == 0 ? 1.3 : 1.0);
    if (HasFatalFailure()) return;
  }
  std::printf("%zu of %zu hypotheses left open; proven %d times, not %d times\n", tally.left,
              tally.hypotheses, tally.proven, tally.not_proven);
  EXPECT_GT(tally.left, tally.hypotheses / 5);
  EXPECT_GT(tally.proven, 50);
  EXPECT_GT(tally.not_proven, 50);
  EXPECT_GT(tally.greedy, problems / 2);
}

}  // namespace
}  // namespace perch
