// The bounds and both searches against enumeration: hundreds of small random problems, every arrangement of
// their candidates tried.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "perch/candidates/partial_bound.hpp"
#include "perch/core/random.hpp"
#include "perch/heuristics/heuristics.hpp"
#include "perch/localize/exhaustive.hpp"
#include "perch/search/branch_and_bound.hpp"
#include "perch/search/focal_mha.hpp"
#include "perch/tree/scene_branching.hpp"
#include "small_problem.hpp"

namespace perch {
namespace {

constexpr int problems = 240;

/// A random scene of 2 to 4 objects, some of them with clutter, and of models that may rest in several ways
/// in one of five.
std::unique_ptr<SmallProblem> random_problem(std::uint64_t seed) {
  Random random(seed);
  const bool noise = random.below(2) == 0, repeats = random.below(4) == 0;
  const RefineMethod refine = random.below(3) == 0 ? RefineMethod::none : RefineMethod::icp;
  const int objects = 2 + static_cast<int>(random.below(3));
  SimulatedScene simulated = small_tabletop(seed, noise, objects, repeats, random.below(4) == 0);
  if (seed % 5 == 0) simulated = with_rest_poses(simulated, seed);
  Settings settings = small_settings(refine);
  add_clutter(simulated.scene, settings, random);
  auto small = std::make_unique<SmallProblem>(std::move(simulated), settings);
  if (random.below(3) == 0) small->settings.tree = {0.0, 0};
  return small;
}

/// Leaves a few candidates of each kind: some of those that explain most, and others at random.
void thin_out(SmallProblem& small, Random& random) {
  const std::size_t objects = small.problem->object_count();
  const std::size_t most = objects == 4 ? 5 : objects == 3 ? 8 : 20;
  std::vector<char> keep(small.set.size(), 0);
  for (std::size_t kind = 0; kind < small.problem->kinds(); ++kind) {
    auto ids = small.set.of_kind(kind);
    std::stable_sort(ids.begin(), ids.end(), [&](CandidateId a, CandidateId b) {
      return small.set[a].explained_count > small.set[b].explained_count;
    });
    const std::size_t good = std::min(ids.size(), 2 * most);
    for (std::size_t i = 0; i < most && good > 0; ++i)
      keep[i < most / 2 ? ids[random.below(good)] : ids[random.below(ids.size())]] = 1;
    for (const CandidateId id : ids) keep[id] = keep[id] || small.set[id].absent;
  }
  small.set.restrict_to(keep);
}

bool holds(const std::vector<CandidateId>& scene, const std::vector<CandidateId>& part) {
  return std::includes(scene.begin(), scene.end(), part.begin(), part.end());
}

/// Calls `check` with the seed, the problem and what its enumeration gave; several problems a scene.
template <typename Check>
void for_each_problem(Check check) {
  constexpr std::uint64_t problems_a_scene = 6;
  for (std::uint64_t scene = 1; scene <= problems / problems_a_scene; ++scene) {
    const auto small = random_problem(scene);
    const CandidateSet whole = small->set;
    for (std::uint64_t i = 0; i < problems_a_scene; ++i) {
      const std::uint64_t seed = scene * problems_a_scene + i;
      SCOPED_TRACE(testing::Message() << "scene " << scene << " seed " << seed);
      small->set = whole;
      Random random(seed);
      thin_out(*small, random);
      check(seed, *small, enumerate(*small));
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

// One loop over the problems, since enumerating takes most of the time.
TEST(EnumerationHeavy, BoundsHoldAndSearchesFindTheOptimum) {
  int infeasible = 0, not_monotone = 0, branched = 0;
  for_each_problem([&](std::uint64_t seed, SmallProblem& small, const Enumerated& expected) {
    const LocalizationProblem& problem = *small.problem;
    const StopCondition never;
    const Enumeration all =
        enumerate_scenes(problem, small.set, small.makers, small.executor, nullptr, never);
    ASSERT_EQ(all.scenes, static_cast<std::int64_t>(expected.scenes.size()));
    ASSERT_EQ(all.best ? all.best->cost : none, expected.best);
    const Enumeration monotone =
        enumerate_scenes(problem, small.set, small.makers, small.executor, &small.settings.tree, never);
    ASSERT_EQ(monotone.best ? monotone.best->cost : none, expected.best_in_tree);
    infeasible += expected.best == none;
    not_monotone += expected.best_in_tree != expected.best;

    // The whole set's bound: of every scene by its reduced costs, with a poor scene known and with none.
    std::int64_t upper = std::int64_t{1} << 40;
    Random random(seed);
    if (!expected.scenes.empty() && random.below(4) != 0)
      upper = expected.scenes[random.below(expected.scenes.size())].cost;
    LagrangianBound bound(problem, small.set);
    for (int round = 0; round < 3; ++round) {
      bound.improve(20, upper, 1e18, small.executor, never);
      if (round == 1) bound.widen_certain(small.makers, small.executor);
    }
    ASSERT_LE(std::min(upper, bound.lower_bound()), expected.best);
    const ReducedCosts reduced = bound.reduced_costs();
    for (const CandidateScene& scene : expected.scenes) {
      ReducedCosts::Weight sum = reduced.base();
      bool kept = true;
      for (const CandidateId id : scene.candidates) {
        kept = kept && bound.kept()[id] != 0;
        sum += reduced.reduced_cost(id);
      }
      ASSERT_LE(kept ? std::min(upper, Lagrangian::count(sum)) : upper, scene.cost);
    }

    // The bound with exact visibility: of every scene that holds a given candidate.
    if (!expected.scenes.empty()) {
      const CandidateId first =
          expected.scenes[random.below(expected.scenes.size())].candidates[random.below(2)];
      std::vector<OpenSlot> slots;
      for (std::size_t kind = 0; kind < problem.kinds(); ++kind) {
        const int left = problem.copies()[kind] - static_cast<int>(small.set.kind(first) == kind);
        if (left == 0) continue;
        slots.push_back({left, slots.size(), {}});
        for (const CandidateId id : small.set.of_kind(kind))
          if (!problem.collide(small.set[first], small.set[id])) slots.back().choices.push_back({id, 0});
      }
      Composite placed = problem.cost().empty();
      CandidateMaker& maker = small.makers.front();
      problem.cost().add(placed, maker.patch(small.set[first]), maker.scratch());
      const PartialBound partial =
          bound_partial_scene(problem, small.set, placed, slots, bound.point_weights(), upper, maker, never);
      for (const CandidateScene& scene : expected.scenes) {
        if (!holds(scene.candidates, {first})) continue;
        ASSERT_LE(std::min(upper, partial.lower_bound), scene.cost);
        Lagrangian::Weight sum = partial.base;
        bool first_met = false, kept = partial.lower_bound < upper;
        for (const CandidateId id : scene.candidates) {
          if (id == first && !std::exchange(first_met, true)) continue;
          bool found = false;
          for (const OpenSlot& slot : partial.slots)
            for (const OpenSlot::Choice& choice : slot.choices)
              if (choice.id == id) {
                sum += choice.reduced_cost;
                found = true;
              }
          kept = kept && found;
        }
        ASSERT_LE(kept ? std::min(upper, Lagrangian::count(sum)) : upper, scene.cost);
      }
    }

    // Branch and bound, with a poor scene known or none, from the bound as it is.
    for (const double w : {1.0, 1.2, 3.0}) {
      SceneBranching branching(problem, small.set, small.makers, small.executor, bound, never);
      BranchAndBoundOptions options;
      options.w = w;
      std::optional<Incumbent<SceneBranching::Solution>> known;
      for (const CandidateScene& scene : expected.scenes)
        if (scene.cost == upper && !known) known = {scene.candidates, static_cast<double>(scene.cost)};
      const auto found = branch_and_bound(branching, options, never, known);
      if (expected.best == none) {
        ASSERT_EQ(found.reason, StopReason::infeasible);
        continue;
      }
      ASSERT_EQ(found.reason, StopReason::solved);
      const auto best = static_cast<double>(expected.best);
      ASSERT_LE(found.lower_bound, best);
      ASSERT_GE(found.incumbent->cost, best);
      ASSERT_LE(found.incumbent->cost, w * best);
      ASSERT_EQ(found.incumbent->cost, static_cast<double>(small.flat_cost(found.incumbent->state)));
      ASSERT_TRUE(small.collision_free(found.incumbent->state));
      if (w == 1.0) branched += found.counters.expanded > 1;
    }

    // Focal-MHA* over the monotone tree, with the Lagrangian bound where a scene of the tree is known.
    const auto in_tree = std::find_if(expected.scenes.begin(), expected.scenes.end(),
                                      [&](const CandidateScene& s) { return s.cost == upper; });
    SceneTree tree = tree_of(small);
    std::optional<Incumbent<SceneState>> known;
    if (in_tree != expected.scenes.end() && tree.contains(in_tree->candidates)) {
      tree.use(reduced, bound.lower_bound(), upper);
      known = {tree.state_of(in_tree->candidates), static_cast<double>(upper)};
    }
    Heuristics<SceneState> heuristics;
    heuristics.admissible = bound_heuristic;
    heuristics.inadmissible = {DepthHeuristic(problem.object_count()), OverlapHeuristic(problem, small.set)};
    const auto found = focal_mha(tree, heuristics, {.w = 1.0}, never, known);
    ASSERT_EQ(found.incumbent ? static_cast<std::int64_t>(found.incumbent->cost) : none,
              expected.best_in_tree);
  });
  std::printf("%d problems: %d infeasible, %d where the best scene has no monotone order, %d branched\n",
              problems, infeasible, not_monotone, branched);
  EXPECT_LT(infeasible, problems / 4);
  EXPECT_GT(not_monotone, 0);
  EXPECT_GT(branched, problems / 10);
}

}  // namespace
}  // namespace perch
