// The tree against enumeration: every arrangement of small random scenes is tried.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "perch/candidates/first_scenes.hpp"
#include "perch/candidates/lagrangian_bound.hpp"
#include "perch/core/random.hpp"
#include "perch/heuristics/heuristics.hpp"
#include "perch/search/focal_mha.hpp"
#include "small_problem.hpp"

namespace perch {
namespace {

struct TreeCase {
  std::uint64_t seed;
  bool noise;
  RefineMethod refine;
  int objects;
  bool repeats;
};

std::vector<TreeCase> tree_cases() {
  std::vector<TreeCase> all;
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    all.push_back({seed, seed % 2 == 0, seed % 3 == 0 ? RefineMethod::none : RefineMethod::icp,
                   seed % 4 == 0 ? 2 : 3, seed % 5 == 0});
  return all;
}

#define PERCH_TRACE(c)                                                                             \
  SCOPED_TRACE(testing::Message() << "seed " << (c).seed << " noise " << (c).noise << " refine "   \
                                  << name((c).refine) << " objects " << (c).objects << " repeats " \
                                  << (c).repeats)

// Random descents: edges add up to the flat J of the goal, no prefix and no bound exceeds it, bounds never
// fall.
TEST(SceneTreeHeavy, EdgesAddUpToTheFlatCost) {
  int goals = 0;
  for (const TreeCase& c : tree_cases()) {
    PERCH_TRACE(c);
    SmallProblem small(c.seed, c.noise, c.refine, c.objects, c.repeats);
    for (const bool strict : {true, false}) {
      if (strict) small.settings.tree = {0.0, 0};
      SceneTree tree = tree_of(small);
      Random random(c.seed);
      for (int descent = 0; descent < 12; ++descent) {
        std::vector<SceneState> path{tree.root()};
        double sum = 0.0;
        while (!tree.is_goal(path.back())) {
          const auto expansion = tree.expand(path.back(), StopCondition());
          if (expansion.edges.empty()) break;
          const auto& edge = expansion.edges[random.below(expansion.edges.size())];
          ASSERT_GE(edge.cost, 0.0);
          ASSERT_GE(edge.state.bound, path.back().bound);
          ASSERT_GE(edge.state.bound, edge.state.cost);
          sum += edge.cost;
          path.push_back(edge.state);
        }
        if (!tree.is_goal(path.back())) continue;
        ++goals;
        const std::int64_t flat = small.flat_cost(path.back().placed);
        ASSERT_EQ(sum, static_cast<double>(flat));
        for (const SceneState& state : path) {
          ASSERT_LE(state.cost, flat);
          ASSERT_LE(state.bound, flat);
        }
      }
    }
  }
  EXPECT_GT(goals, 80);
}

// h of a state never exceeds what is left to the best goal below it, by enumeration of all goals.
TEST(SceneTreeHeavy, BoundsHoldForEveryGoalBelow) {
  for (const TreeCase& c : tree_cases()) {
    PERCH_TRACE(c);
    SmallProblem small(c.seed, c.noise, c.refine, 2, c.repeats);
    SceneTree tree = tree_of(small);
    for (const auto& first : tree.expand(tree.root(), StopCondition()).edges) {
      std::int64_t best = none;
      for (const auto& goal : tree.expand(first.state, StopCondition()).edges)
        best = std::min(best, goal.state.cost);
      ASSERT_LE(first.state.bound, best);
    }
  }
}

// ICP in context: hypotheses that the parent leaves as they are alone are not refined again. The edges are
// the ones of a tree that refines every hypothesis at every parent.
TEST(SceneTreeHeavy, LazyEdgesAreTheEagerOnes) {
  std::int64_t reused = 0, hypotheses = 0;
  for (const TreeCase& c : tree_cases()) {
    PERCH_TRACE(c);
    SmallProblem small(c.seed, c.noise, c.refine, c.objects, c.repeats);
    CandidateSet lazy_set(*small.problem), eager_set(*small.problem);
    SceneTree lazy =
        SceneTree::in_context(*small.problem, lazy_set, small.makers, small.executor, small.settings.tree);
    SceneTree eager =
        SceneTree::in_context(*small.problem, eager_set, small.makers, small.executor, small.settings.tree);
    eager.forget_lone_hypotheses();
    Random random(c.seed);
    for (int descent = 0; descent < 3; ++descent) {
      SceneState state = lazy.root();
      while (!lazy.is_goal(state)) {
        const auto a = lazy.expand(state, StopCondition()), b = eager.expand(state, StopCondition());
        ASSERT_EQ(a.edges.size(), b.edges.size());
        for (std::size_t i = 0; i < a.edges.size(); ++i) {
          ASSERT_EQ(a.edges[i].state.placed, b.edges[i].state.placed);
          ASSERT_EQ(a.edges[i].cost, b.edges[i].cost);
          ASSERT_EQ(a.edges[i].state.bound, b.edges[i].state.bound);
        }
        if (a.edges.empty()) break;
        state = a.edges[random.below(a.edges.size())].state;
      }
    }
    ASSERT_EQ(lazy_set.size(), eager_set.size());
    for (CandidateId id = 0; id < lazy_set.size(); ++id) ASSERT_EQ(lazy_set[id].pose, eager_set[id].pose);
    reused += lazy.reused();
    hypotheses += lazy.hypotheses();
    EXPECT_EQ(eager.reused(), 0);
  }
  EXPECT_GT(reused, hypotheses / 4);
  EXPECT_LT(reused, hypotheses);
}

TEST(SceneTreeHeavy, FocalMhaFindsTheEnumeratedOptimum) {
  std::uint64_t expanded = 0, expanded_without = 0;
  for (const TreeCase& c : tree_cases()) {
    PERCH_TRACE(c);
    SmallProblem small(c.seed, c.noise, c.refine, c.objects, c.repeats);
    SceneTree with_bound = tree_of(small);
    const Enumerated expected = enumerate(small);
    Heuristics<SceneState> heuristics;
    heuristics.admissible = bound_heuristic;
    heuristics.inadmissible = {DepthHeuristic(small.problem->object_count()),
                               OverlapHeuristic(*small.problem, small.set)};
    SceneTree without_bound = tree_of(small);
    without_bound.forget_cover_bound();
    for (const auto& [tree, w] : {std::pair(&with_bound, 1.0), std::pair(&with_bound, 1.2),
                                  std::pair(&with_bound, 3.0), std::pair(&without_bound, 1.0)}) {
      FocalMhaOptions options;
      options.w = w;
      const auto found = focal_mha(*tree, heuristics, options, StopCondition());
      if (w == 1.0) (tree == &with_bound ? expanded : expanded_without) += found.counters.expanded;
      if (expected.best_in_tree == none) {
        EXPECT_EQ(found.reason, StopReason::infeasible);
        continue;
      }
      ASSERT_TRUE(found.incumbent);
      const auto best = static_cast<double>(expected.best_in_tree);
      EXPECT_EQ(found.incumbent->cost, static_cast<double>(small.flat_cost(found.incumbent->state.placed)));
      EXPECT_TRUE(tree->contains(found.incumbent->state.placed));
      EXPECT_LE(found.lower_bound, best);
      EXPECT_GE(found.incumbent->cost, best);
      EXPECT_LE(found.incumbent->cost, w * best);
    }
  }
  EXPECT_LT(2 * expanded, expanded_without);
}

TEST(LagrangianBoundHeavy, HoldsForEveryCollisionFreeScene) {
  for (const TreeCase& c : tree_cases()) {
    PERCH_TRACE(c);
    SmallProblem small(c.seed, c.noise, c.refine, c.objects, c.repeats);
    const auto scenes =
        first_scenes(*small.problem, small.set, small.makers, small.executor, StopCondition());
    if (scenes.empty()) continue;
    const Enumerated expected = enumerate(small);
    const std::int64_t upper = scenes.front().cost;
    LagrangianBound bound(*small.problem, small.set);
    for (int round = 0; round < 4; ++round) {
      bound.improve(40, upper, 1e18, small.executor, StopCondition());
      EXPECT_LE(std::min(upper, bound.lower_bound()), expected.best);
      // A dropped candidate is part of no scene that is cheaper than the known one; what is kept is bounded
      // by its reduced costs.
      for (const CandidateScene& scene : expected.scenes) {
        ReducedCosts::Weight sum = bound.reduced_costs().base();
        bool kept = true;
        for (const CandidateId id : scene.candidates) {
          kept = kept && bound.kept()[id] != 0;
          sum += bound.reduced_costs().reduced_cost(id);
        }
        if (kept) {
          ASSERT_LE(std::min(upper, Lagrangian::count(sum)), scene.cost);
        } else {
          ASSERT_GE(scene.cost, upper);
        }
      }
      bound.separate_copies(scenes.front().candidates, 40, upper, small.executor, StopCondition());
      bound.widen_certain(small.makers, small.executor);
    }
  }
}

TEST(FirstScenesHeavy, AreWhatTheySay) {
  for (const TreeCase& c : tree_cases()) {
    PERCH_TRACE(c);
    SmallProblem small(c.seed, c.noise, c.refine, c.objects, c.repeats);
    std::int64_t last = 0;
    for (const auto& scene :
         first_scenes(*small.problem, small.set, small.makers, small.executor, StopCondition())) {
      EXPECT_EQ(scene.candidates.size(), small.problem->object_count());
      EXPECT_EQ(scene.cost, small.flat_cost(scene.candidates));
      EXPECT_TRUE(small.collision_free(scene.candidates));
      EXPECT_GE(scene.cost, last);
      last = scene.cost;
    }
  }
}

// k copies of a model are one multiset, not k! sequences: the tree has as many goal states as there are sets.
TEST(SceneTree, RepeatsAreInterchangeable) {
  SmallProblem small(5, false, RefineMethod::none, 3, true);
  ASSERT_EQ(small.problem->copies().size(), 1U);
  ASSERT_EQ(small.problem->copies()[0], 3);
  small.settings.tree = {1.0, 1000000};  // everything is monotone
  SceneTree tree = tree_of(small);
  std::set<std::vector<CandidateId>> level{{}}, next;
  for (int depth = 0; depth < 3; ++depth) {
    for (const auto& placed : level) {
      SceneState state;
      state.placed = placed;
      for (const auto& edge : tree.expand(state, StopCondition()).edges) {
        ASSERT_TRUE(std::is_sorted(edge.state.placed.begin(), edge.state.placed.end()));
        next.insert(edge.state.placed);
      }
    }
    level = std::exchange(next, {});
  }
  std::size_t expected = 0;
  small.for_each_scene(
      [&](const std::vector<CandidateId>& placed) { expected += small.collision_free(placed); });
  EXPECT_EQ(level.size(), expected);
  EXPECT_GT(expected, 10U);
}

}  // namespace
}  // namespace perch
