// Poses that another detector proposes may guide a search, but never change what it guarantees.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <numbers>

#include "perch/candidates/root_bound.hpp"
#include "perch/core/random.hpp"
#include "perch/heuristics/heuristics.hpp"
#include "perch/localize/localize.hpp"
#include "perch/localize/scene_search.hpp"
#include "perch/search/focal_mha.hpp"
#include "small_problem.hpp"

namespace perch {
namespace {

std::vector<PriorPose> true_priors(const SmallProblem& small) {
  Scene scene = small.simulated.scene;
  scene.priors.clear();
  for (const TruthPose& truth : scene.truth) scene.priors.push_back({truth.model, truth.pose});
  return priors_of(scene, *small.problem);
}

struct Named {
  std::string name;
  std::vector<PriorPose> priors;
};

/// None, the truth, and whatever might mislead.
std::vector<Named> all_priors(const SmallProblem& small, Random& random) {
  const std::vector<PriorPose> truth = true_priors(small);
  const std::size_t models = small.problem->models().size();
  const Workspace& w = small.problem->workspace(0);
  const auto anywhere = [&](double scale) {
    return PriorPose{random.below(models),
                     {scale * random.uniform(w.x_min, w.x_max), scale * random.uniform(w.y_min, w.y_max),
                      scale * random.uniform(-std::numbers::pi, std::numbers::pi)}};
  };
  std::vector<Named> all{{"none", {}}, {"truth", truth}};
  Named far{"far off", truth}, other{"poses of other objects", truth}, many{"thousands", {}},
      wrong{"wrong", {}}, one{"the same for all", {}}, opposite{"the other side", truth};
  for (PriorPose& prior : far.priors) {
    prior.pose.x = random.uniform() < 0.5 ? 1e300 : -1e6;
    prior.pose.yaw = 1e12;
  }
  for (std::size_t i = 0; i < other.priors.size(); ++i)
    other.priors[i].pose = truth[(i + 1) % truth.size()].pose;
  for (int i = 0; i < 3000; ++i) many.priors.push_back(anywhere(i % 10 == 0 ? 100.0 : 1.0));
  for (int i = 0; i < 3; ++i) wrong.priors.push_back(anywhere(1.0));
  for (int i = 0; i < 20; ++i) one.priors.push_back({random.below(models), truth.front().pose});
  for (PriorPose& prior : opposite.priors) {
    prior.pose.x = -prior.pose.x;
    prior.pose.y = -prior.pose.y;
  }
  all.insert(all.end(), {far, other, many, wrong, one, opposite});
  return all;
}

SearchResult<SceneState> focal_from_nothing(SmallProblem& small, const std::vector<PriorPose>& priors,
                                            const FocalMhaOptions& options) {
  SceneTree tree =
      SceneTree::fixed(*small.problem, small.set, small.makers, small.executor, small.settings.tree);
  Heuristics<SceneState> heuristics;
  heuristics.admissible = bound_heuristic;
  heuristics.inadmissible = {DepthHeuristic(small.problem->object_count()),
                             OverlapHeuristic(*small.problem, small.set)};
  if (!priors.empty()) heuristics.inadmissible.push_back(PriorHeuristic(*small.problem, small.set, priors));
  return focal_mha(tree, heuristics, options, StopCondition());
}

TEST(PriorsHeavy, NeverChangeTheGuarantee) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Settings settings = small_settings(seed % 3 == 0 ? RefineMethod::none : RefineMethod::icp);
    settings.candidates.grid.yaw_resolution = 3.2;
    SmallProblem small(small_tabletop(seed, seed % 2 == 0, seed % 4 == 0 ? 3 : 2, seed % 4 == 0), settings);
    const Enumerated expected = enumerate(small);
    Random random(seed);
    for (const Named& priors : all_priors(small, random))
      for (const double w : {1.0, 1.3, 3.0}) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", priors " << priors.name << ", w " << w);
        const auto check = [w](std::int64_t best, std::optional<std::int64_t> cost, std::int64_t bound) {
          ASSERT_EQ(cost.has_value(), best != none);
          if (!cost) return;
          EXPECT_GE(*cost, best);
          EXPECT_LE(static_cast<double>(*cost), w * static_cast<double>(best));
          EXPECT_LE(static_cast<double>(*cost), w * static_cast<double>(bound));
          EXPECT_LE(bound, best);
        };
        settings.w = w;
        for (const SearchMethod method : {SearchMethod::branch_and_bound, SearchMethod::focal_mha}) {
          SCOPED_TRACE(name(method));
          settings.method = method;
          const std::function<void(const Progress&)> nobody;
          ProgressLog log(nobody);
          FixedCandidates candidates = *small.refined;
          const SearchOutcome found = search_fixed(*small.problem, candidates, small.makers, priors.priors,
                                                   settings, small.executor, StopCondition(), log);
          check(method == SearchMethod::branch_and_bound ? expected.best : expected.best_in_tree,
                found.scenes.empty() ? std::nullopt : std::optional(found.scenes.front().cost),
                found.lower_bound);
        }
        const auto found = focal_from_nothing(small, priors.priors, {.w = w});
        check(
            expected.best_in_tree,
            found.incumbent ? std::optional(static_cast<std::int64_t>(found.incumbent->cost)) : std::nullopt,
            found.incumbent ? static_cast<std::int64_t>(found.lower_bound) : 0);
      }
  }
}

TEST(Priors, StartAGreedyScene) {
  int started = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    SmallProblem small(small_tabletop(seed, true, 2, false), small_settings(RefineMethod::icp));
    const std::vector<PriorPose> priors = true_priors(small);
    FixedCandidates candidates = *small.refined;
    RootBound root(*small.problem, candidates, small.executor);
    ASSERT_TRUE(root.value_near(priors, StopCondition()));
    const std::vector<CandidateId> nearest = nearest_to_priors(*small.problem, candidates.set(), priors);
    const auto scene = root.greedy_scene(nearest, small.makers.front(), StopCondition());
    if (!scene) continue;
    ++started;
    EXPECT_EQ(scene->candidates.size(), small.problem->object_count());
    for (const CandidateId id : nearest)
      EXPECT_EQ(std::count(scene->candidates.begin(), scene->candidates.end(), id), 1);
    EXPECT_EQ(candidates.count(), small.refined->count());
  }
  EXPECT_GT(started, 2);
}

/// Expansions until the run met a scene that costs no more than this; `never` where it met none.
double expansions_until(const Result& result, double cost, double never) {
  for (const TraceEntry& entry : result.trace)
    if (entry.search_cost && static_cast<double>(*entry.search_cost) <= cost)
      return static_cast<double>(entry.expanded);
  return never;
}

// In context no scene is known before the search: right priors lead to a good one at once.
TEST(PriorsHeavy, RightOnesCutTheExpansionsToAGoodScene) {
  double without = 0.0, right = 0.0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = small_tabletop(seed, seed % 2 == 0, 3, false).scene;
    Settings settings = small_settings(RefineMethod::icp);
    settings.candidates.grid.resolution = 0.07;
    settings.mode = CandidateMode::context;
    settings.max_expansions = 30;
    const SerialExecutor executor;
    const Result plain = localize(scene, settings, executor, StopCondition());
    for (const TruthPose& truth : scene.truth) scene.priors.push_back({truth.model, truth.pose});
    const Result guided = localize(scene, settings, executor, StopCondition());
    for (PlacedModel& prior : scene.priors) prior.pose = {-prior.pose.x, -prior.pose.y, prior.pose.yaw + 1.5};
    const Result misled = localize(scene, settings, executor, StopCondition());
    ASSERT_TRUE(plain.search_cost && guided.search_cost && misled.search_cost);
    const std::int64_t best = std::min({*plain.search_cost, *guided.search_cost, *misled.search_cost});
    for (const Result* result : {&plain, &guided, &misled}) EXPECT_LE(result->lower_bound, best);
    const double good = 1.25 * static_cast<double>(best);
    without += expansions_until(plain, good, 30.0);
    right += expansions_until(guided, good, 30.0);
  }
  EXPECT_LT(4.0 * right, without);
}

}  // namespace
}  // namespace perch
