// Objects that interlock hide one another, whatever the order: no monotone order exists. Branch and bound
// finds such scenes, Focal-MHA* the best of the others; each against enumeration of its own set.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <numeric>

#include "perch/candidates/lagrangian_bound.hpp"
#include "perch/core/random.hpp"
#include "perch/heuristics/heuristics.hpp"
#include "perch/localize/localize.hpp"
#include "perch/search/focal_mha.hpp"
#include "perch/sim/mesh_builder.hpp"
#include "perch/tree/scene_branching.hpp"
#include "small_problem.hpp"

namespace perch {
namespace {

Mesh box_at(const Eigen::Vector3d& size, const Eigen::Vector3d& at) {
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.translation() = at;
  return moved(box(size, 0.03), transform);
}

/// Two arms along x, 4 cm between them, joined at their lower x end: opens towards x.
SceneModel horseshoe() {
  return {"horseshoe",
          merged({box_at({0.14, 0.03, 0.06}, {0, -0.035, 0}), box_at({0.14, 0.03, 0.06}, {0, 0.035, 0}),
                  box_at({0.03, 0.10, 0.06}, {-0.055, 0, 0})}),
          Symmetry::none(), 0.0};
}

/// A ring that stands on its edge, as a mug's handle without the mug: in the plane x = 0.
SceneModel ring() {
  return {"ring",
          merged({box_at({0.025, 0.025, 0.12}, {0, -0.055, 0}), box_at({0.025, 0.025, 0.12}, {0, 0.055, 0}),
                  box_at({0.025, 0.13, 0.02}, {0, 0, 0}), box_at({0.025, 0.13, 0.025}, {0, 0, 0.095})}),
          Symmetry::n_fold(2), 0.0};
}

/// A hook that reaches through the ring at the height of its hole: a foot, and a beam along x.
SceneModel hook() {
  return {"hook",
          merged({box_at({0.03, 0.05, 0.08}, {-0.07, 0, 0}), box_at({0.15, 0.03, 0.03}, {-0.01, 0, 0.04})}),
          Symmetry::none(), 0.0};
}

/// What an ideal camera sees of the layout, at 80 x 60 pixels.
SimulatedScene seen(SceneLayout layout, const Eigen::Vector3d& eye) {
  layout.camera = camera_looking_at({80, 60, 90, 90, 39.5, 29.5}, eye, {0, 0, 0.03});
  return simulate(layout, DepthSensorSettings::clean(), 1);
}

/// Truths lie on the grid of the workspace, or, with jitter, a little off it.
void jitter(SceneLayout& layout, std::uint64_t seed) {
  if (seed == 0) return;
  Random random(seed);
  for (PlacedModel& object : layout.objects) {
    object.pose.x += random.uniform(-0.006, 0.006);
    object.pose.y += random.uniform(-0.006, 0.006);
    object.pose.yaw += random.uniform(-0.05, 0.05);
  }
}

SimulatedScene horseshoes(std::uint64_t seed, bool with_post) {
  SceneLayout layout;
  layout.name = "horseshoes";
  layout.models = {horseshoe()};
  layout.objects = {{0, {-0.035, -0.0175, 0.0}}, {0, {0.035, 0.0175, std::numbers::pi}}};
  layout.workspace = {-0.035, 0.035, -0.0525, 0.0525};
  if (with_post) {  // beside them, and in front of a part of both
    layout.models.push_back({"post", box({0.02, 0.02, 0.07}, 0.03), Symmetry::continuous(), 0.0});
    layout.objects.push_back({1, {0.0, -0.0525 - 0.035, 0.0}});
    layout.workspace = {-0.035, 0.035, -0.0875, 0.0175};
  }
  jitter(layout, seed);
  return seen(layout, {0.0, -0.6, 0.35});
}

SimulatedScene hook_in_ring(std::uint64_t seed) {
  SceneLayout layout;
  layout.name = "hook_in_ring";
  layout.models = {ring(), hook()};
  layout.objects = {{0, {0.0, 0.0, 0.0}}, {1, {0.0, 0.0, 0.0}}};
  layout.workspace = {-0.07, 0.07, -0.035, 0.035};
  jitter(layout, seed);
  return seen(layout, {0.45, -0.45, 0.25});
}

Settings strict(RefineMethod refine) {
  Settings settings;
  settings.candidates.grid.resolution = 0.035;
  settings.candidates.grid.yaw_resolution = std::numbers::pi / 2;
  settings.candidates.cost.delta = 0.006;
  settings.candidates.refine.method = refine;
  settings.candidates.collision.penetration = 0.004;
  settings.tree = {0.0, 0};
  settings.w = 1.0;
  return settings;
}

/// By trying every order: some one of them never hides a rendered pixel.
bool has_monotone_order(const std::vector<DepthPatch>& patches) {
  std::vector<std::size_t> order(patches.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  do {
    bool monotone = true;
    for (std::size_t later = 1; later < order.size(); ++later) {
      const DepthPatch& added = patches[order[later]];
      for (int v = added.window.v0; v < added.window.v1; ++v)
        for (int u = added.window.u0; u < added.window.u1; ++u) {
          float nearest = no_surface;
          for (std::size_t earlier = 0; earlier < later; ++earlier)
            nearest = std::min(nearest, patches[order[earlier]].at_or_none(u, v));
          if (nearest < no_surface && added.at(u, v) < nearest) monotone = false;
        }
    }
    if (monotone) return true;
  } while (std::next_permutation(order.begin(), order.end()));
  return false;
}

/// Like Enumerated, but its monotone orders are found here, from the renderings alone.
struct EnumeratedOrders {
  std::int64_t best = none;           ///< of all scenes free of collisions
  std::int64_t best_monotone = none;  ///< of those with a monotone order
  int scenes = 0, monotone = 0;
};

EnumeratedOrders enumerate_orders(SmallProblem& small) {
  EnumeratedOrders result;
  small.for_each_scene([&](const std::vector<CandidateId>& placed) {
    if (!small.collision_free(placed)) return;
    ++result.scenes;
    const std::int64_t cost = small.flat_cost(placed);
    result.best = std::min(result.best, cost);
    std::vector<DepthPatch> patches;
    for (const CandidateId id : placed) patches.push_back(small.makers.front().patch(small.set[id]));
    if (!has_monotone_order(patches)) return;
    ++result.monotone;
    result.best_monotone = std::min(result.best_monotone, cost);
  });
  return result;
}

struct Case {
  std::string name;
  SimulatedScene scene;
  RefineMethod refine;
  bool on_grid;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (std::uint64_t seed = 0; seed <= 3; ++seed) {
    const RefineMethod refine = seed == 3 ? RefineMethod::icp : RefineMethod::none;
    const std::string suffix = " " + std::to_string(seed);
    all.push_back({"horseshoes" + suffix, horseshoes(seed, seed == 1), refine, seed == 0});
    all.push_back({"hook in ring" + suffix, hook_in_ring(seed), refine, seed == 0});
  }
  return all;
}

TEST(MutualOcclusion, TheTruthHasNoMonotoneOrder) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Scene& scene = c.scene.scene;
    std::vector<PlacedModel> truth;
    for (const TruthPose& t : scene.truth) truth.push_back({t.model, t.pose});
    const SerialExecutor executor;
    const ScoreRecord record = score(scene, {truth}, strict(c.refine), executor).front();
    EXPECT_FALSE(record.monotone);
    EXPECT_FALSE(record.collides);
    EXPECT_EQ(record.cost.cost, 0);
  }
}

/// By localize, with all that it does before the search.
void check_localize(const Case& c, const EnumeratedOrders& expected) {
  Settings settings = strict(c.refine);
  const SerialExecutor executor;
  for (const double w : {1.0, 1.5}) {
    SCOPED_TRACE(testing::Message() << "w " << w);
    settings.w = w;
    const auto check = [&](const Result& result, std::int64_t best) {
      EXPECT_EQ(result.status, best == none ? Status::infeasible : Status::solved);
      ASSERT_EQ(result.search_cost.has_value(), best != none);
      if (best == none) return;
      EXPECT_LE(static_cast<double>(*result.search_cost), w * static_cast<double>(best));
      EXPECT_GE(*result.search_cost, best);
      EXPECT_LE(result.lower_bound, best);
    };
    settings.method = SearchMethod::branch_and_bound;
    const Result all = localize(c.scene.scene, settings, executor, StopCondition());
    check(all, expected.best);
    EXPECT_EQ(all.guarantee.search, "branch-and-bound");
    EXPECT_NE(all.guarantee.over.find("mutual occlusion included"), std::string::npos);

    settings.method = SearchMethod::focal_mha;
    const Result monotone = localize(c.scene.scene, settings, executor, StopCondition());
    check(monotone, expected.best_monotone);
    EXPECT_EQ(monotone.guarantee.search, "focal-mha");
    EXPECT_NE(monotone.guarantee.over.find("monotone scene generation tree"), std::string::npos);
    EXPECT_EQ(monotone.guarantee.over.find("mutual occlusion"), std::string::npos);
  }
}

/// The searches alone: no first scene, no candidate dropped beforehand.
void check_from_nothing(SmallProblem& small, const EnumeratedOrders& expected) {
  const LagrangianBound bound(*small.problem, small.set);
  SceneBranching branching(*small.problem, small.set, small.makers, small.executor, bound, StopCondition());
  const auto all = branch_and_bound(branching, {}, StopCondition());
  EXPECT_EQ(all.reason, StopReason::solved);
  ASSERT_TRUE(all.incumbent);
  EXPECT_EQ(all.incumbent->cost, static_cast<double>(expected.best));
  EXPECT_EQ(all.lower_bound, static_cast<double>(expected.best));
  EXPECT_EQ(small.flat_cost(all.incumbent->state), expected.best);
  EXPECT_TRUE(small.collision_free(all.incumbent->state));

  SceneTree tree =
      SceneTree::fixed(*small.problem, small.set, small.makers, small.executor, small.settings.tree);
  EXPECT_FALSE(tree.contains(all.incumbent->state));
  Heuristics<SceneState> heuristics;
  heuristics.admissible = bound_heuristic;
  heuristics.inadmissible = {DepthHeuristic(small.problem->object_count()),
                             OverlapHeuristic(*small.problem, small.set)};
  const auto monotone = focal_mha(tree, heuristics, {.w = 1.0}, StopCondition());
  ASSERT_EQ(monotone.incumbent.has_value(), expected.best_monotone != none);
  if (!monotone.incumbent) return;
  EXPECT_EQ(monotone.incumbent->cost, static_cast<double>(expected.best_monotone));
  EXPECT_EQ(monotone.lower_bound, static_cast<double>(expected.best_monotone));
  EXPECT_TRUE(tree.contains(monotone.incumbent->state.placed));
}

TEST(MutualOcclusionHeavy, EachSearchFindsTheOptimumOfItsSet) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    SmallProblem small(c.scene, strict(c.refine));
    const EnumeratedOrders expected = enumerate_orders(small);
    ASSERT_LT(expected.best, expected.best_monotone) << "the monotone order is dearer here";
    EXPECT_LT(expected.monotone, expected.scenes);
    if (c.on_grid) {
      EXPECT_EQ(expected.best, 0);
    }
    check_localize(c, expected);
    check_from_nothing(small, expected);
  }
}

}  // namespace
}  // namespace perch
