// The whole method on simulated scenes, and the faults of earlier implementations of it.

#include "perch/localize/localize.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>

#include "cancelling_executor.hpp"
#include "perch/core/instruction_set.hpp"
#include "perch/io/result_json.hpp"
#include "perch/sim/parametric_models.hpp"
#include "perch/sim/scene_generator.hpp"
#include "small_problem.hpp"

namespace perch {
namespace {

Settings quick() {
  Settings settings;
  settings.candidates.grid.resolution = 0.06;
  settings.candidates.grid.yaw_resolution = 0.7854;
  return settings;
}

TabletopOptions clean(int objects, int width = 320, int height = 240) {
  TabletopOptions options;
  options.min_objects = options.max_objects = objects;
  options.noise = false;
  options.width = width;
  options.height = height;
  options.least_visible = 0.4;
  return options;
}

/// The largest error over the objects, by the best assignment among repeats of up to two.
double worst_distance(const Scene& scene, const Result& result) {
  double worst = 0.0;
  for (const TruthPose& truth : scene.truth) {
    double nearest = 1e9;
    for (const ObjectResult& object : result.objects)
      if (object.model == scene.models[truth.model].name)
        nearest = std::min(nearest, std::hypot(object.pose.x - truth.pose.x, object.pose.y - truth.pose.y));
    worst = std::max(worst, nearest);
  }
  return worst;
}

nlohmann::json without_timings(const Result& result) {
  auto json = nlohmann::json::parse(to_json(result));
  json["stats"].erase("seconds");
  json["stats"].erase("threads");
  return json;
}

TEST(LocalizeHeavy, FindsCleanScenes) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const SimulatedScene simulated = random_tabletop(seed, clean(3));
    const SerialExecutor executor;
    const Result result = localize(simulated.scene, quick(), executor, StopCondition());
    EXPECT_EQ(result.status, Status::solved);
    ASSERT_TRUE(result.search_cost);
    EXPECT_LE(*result.search_cost, 3 * result.lower_bound);
    EXPECT_LT(worst_distance(simulated.scene, result), 0.005);
  }
}

TEST(LocalizeHeavy, ScoreAgreesWithTheResult) {
  for (std::uint64_t seed = 11; seed <= 13; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    TabletopOptions options = clean(3);
    options.noise = true;
    const SimulatedScene simulated = random_tabletop(seed, options);
    const SerialExecutor executor;
    const Result result = localize(simulated.scene, quick(), executor, StopCondition());
    ASSERT_TRUE(result.cost);
    std::vector<PlacedModel> placed, searched;
    for (std::size_t i = 0; i < result.objects.size(); ++i) {
      placed.push_back({simulated.scene.objects[i].model, result.objects[i].pose});
      searched.push_back({simulated.scene.objects[i].model, result.search_objects[i].pose});
    }
    const auto records = score(simulated.scene, {placed, searched}, quick(), executor);
    const ScoreRecord& record = records[0];
    EXPECT_EQ(record.cost.cost, result.cost->cost);
    EXPECT_EQ(record.cost.cost_observed, result.cost->cost_observed);
    EXPECT_EQ(record.cost.cost_rendered, result.cost->cost_rendered);
    EXPECT_LE(record.cost.cost, *result.search_cost);
    EXPECT_FALSE(record.collides);
    EXPECT_EQ(records[1].cost.cost, *result.search_cost);
    EXPECT_FALSE(records[1].collides);
    EXPECT_TRUE(records[1].monotone);
    for (const ObjectResult& object : result.objects) EXPECT_TRUE(object.confidence);
    Settings as_searched = quick();
    as_searched.polish.rounds = 0;
    as_searched.ambiguity.trials = 0;
    const Result unpolished = localize(simulated.scene, as_searched, executor, StopCondition());
    EXPECT_EQ(unpolished.cost->cost, *unpolished.search_cost);
    EXPECT_EQ(*unpolished.search_cost, *result.search_cost);
    for (std::size_t i = 0; i < result.objects.size(); ++i) {
      EXPECT_EQ(unpolished.objects[i].pose, result.search_objects[i].pose);
      EXPECT_FALSE(unpolished.objects[i].confidence);
    }
    std::int64_t visible = 0;
    for (const ObjectResult& object : result.objects) visible += object.visible_pixels;
    EXPECT_EQ(visible, record.rendered_points);
  }
}

TEST(LocalizeHeavy, IsTheSameOnAnyNumberOfThreads) {
  TabletopOptions options = clean(3, 160, 120);
  options.noise = true;
  const SimulatedScene simulated = random_tabletop(21, options);
  for (const CandidateMode mode : {CandidateMode::fixed, CandidateMode::context}) {
    Settings settings = quick();
    settings.mode = mode;
    settings.w = 1.5;
    settings.max_expansions = 6;
    std::optional<nlohmann::json> first;
    for (const std::size_t threads : {1, 2, 4}) {
      const auto executor = make_executor(threads);
      const auto json = without_timings(localize(simulated.scene, settings, *executor, StopCondition()));
      if (!first) first = json;
      EXPECT_EQ(json, *first) << threads << " threads";
    }
  }
}

// The kernels of all stages, and candidates that are valued only where they could matter.
TEST(LocalizeHeavy, IsTheSameOnEveryInstructionSet) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const Scene scene = small_tabletop(seed, seed % 2 == 0, 3, seed == 1, seed == 2).scene;
    Settings settings = small_settings(RefineMethod::icp);
    settings.w = seed == 1 ? 1.0 : 1.5;
    settings.ambiguity = {};
    std::optional<nlohmann::json> first;
    for (const auto& [set, threads] :
         {std::pair(InstructionSet::baseline, 1), std::pair(InstructionSet::x86_64_v3, 4),
          std::pair(InstructionSet::x86_64_v4, 1)}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", instruction set " << static_cast<int>(set));
      use_instruction_set(set);
      const auto executor = make_executor(static_cast<std::size_t>(threads));
      const auto json = without_timings(localize(scene, settings, *executor, StopCondition()));
      if (!first) first = json;
      EXPECT_EQ(json, *first);
    }
  }
  use_instruction_set(InstructionSet::x86_64_v4);
}

TEST(Localize, ContextFindsAScene) {
  const SimulatedScene simulated = random_tabletop(31, clean(2, 160, 120));
  Settings settings = quick();
  settings.mode = CandidateMode::context;
  settings.max_expansions = 4;
  const SerialExecutor executor;
  const Result result = localize(simulated.scene, settings, executor, StopCondition());
  ASSERT_TRUE(result.search_cost);
  EXPECT_LT(worst_distance(simulated.scene, result), 0.01);
  EXPECT_LE(result.lower_bound, *result.search_cost);
  // Each (model, grid pose, parent) once.
  const auto problem = make_problem(simulated.scene, settings, executor);
  EXPECT_GT(result.stats.rendered, static_cast<std::int64_t>(problem->grid(0).size()));
}

// Fault: a zero-cost edge is thrown away. A scene whose observation is the rendering of a grid pose has only
// such edges.
TEST(Faults, ZeroCostEdgesAreKept) {
  Scene scene = random_tabletop(41, clean(2, 160, 120)).scene;
  const Pose pose = scene.truth[0].pose;
  scene.objects = {scene.truth[0].model};
  scene.models[scene.objects[0].model].symmetry = Symmetry::continuous();  // one yaw, 0
  scene.workspace = Workspace{pose.x - 1e-3, pose.x + 1e-3, pose.y - 1e-3, pose.y + 1e-3};
  Settings settings = quick();
  settings.candidates.refine.method = RefineMethod::none;
  settings.w = 1.0;
  const SerialExecutor executor;
  const auto problem = make_problem(scene, settings, executor);
  Rasterizer rasterizer(scene.camera.intrinsics);
  DepthPatch patch;
  const std::size_t model = scene.objects[0].model;
  problem->render(model, problem->grid(model).pose(0), rasterizer, patch);
  for (std::size_t i = 0; i < scene.depth.size(); ++i) scene.depth[i] = 0.0F;
  for (int v = patch.window.v0; v < patch.window.v1; ++v)
    for (int u = patch.window.u0; u < patch.window.u1; ++u)
      if (patch.at(u, v) < no_surface) scene.depth(u, v) = patch.at(u, v);
  const Result result = localize(scene, settings, executor, StopCondition());
  EXPECT_EQ(result.status, Status::solved);
  ASSERT_TRUE(result.search_cost);
  EXPECT_EQ(*result.search_cost, 0);
  EXPECT_EQ(result.lower_bound, 0);
  EXPECT_EQ(result.suboptimality_bound(), 1.0);
}

// Faults: the limit is looked at only between expansions; a time-out gives an answer without a bound.
TEST(FaultsHeavy, ALimitIsKeptInsideABatchAndTheBoundIsReported) {
  TabletopOptions options = clean(3, 160, 120);
  options.noise = true;
  const SimulatedScene simulated = random_tabletop(51, options);
  Settings settings = quick();
  settings.w = 1.0;
  int with_scene = 0, without = 0;
  for (const std::int64_t bodies : {5, 600, 2000, 2400, 2600, 2800, 3000, 3500, 5000, 8000}) {
    StopCondition stop;
    const CancellingExecutor executor(stop, bodies);
    const Result result = localize(simulated.scene, settings, executor, stop);
    // Building the look-up structures doesn't ask; everything after does, before each body.
    if (bodies > 1500) {
      EXPECT_LE(executor.after(), 1);
    }
    for (const TraceEntry& entry : result.trace) EXPECT_LE(entry.lower_bound, result.lower_bound);
    if (result.status == Status::solved) continue;
    EXPECT_EQ(result.status, Status::time_limit);
    if (result.search_cost) {
      ++with_scene;
      EXPECT_LE(result.lower_bound, *result.search_cost);
      EXPECT_EQ(result.objects.size(), simulated.scene.objects.size());
    } else {
      ++without;
      EXPECT_EQ(result.lower_bound, 0);
      EXPECT_TRUE(result.objects.empty());
    }
  }
  EXPECT_GT(without, 0);
}

// Fault: image size and depth range are compiled in.
TEST(FaultsHeavy, AnyImageSizeAndDepthRange) {
  for (const auto& [width, height] : {std::pair{37, 53}, std::pair{200, 90}}) {
    SimulatedScene simulated = random_tabletop(61, clean(2, width, height));
    const SerialExecutor executor;
    Settings settings = quick();
    settings.candidates.cost.delta = 0.02;
    settings.max_expansions = 3;
    EXPECT_TRUE(localize(simulated.scene, settings, executor, StopCondition()).search_cost);
    // Five times as large and as far away: the same picture.
    Scene& scene = simulated.scene;
    constexpr float factor = 5.0F;
    for (std::size_t i = 0; i < scene.depth.size(); ++i) scene.depth[i] *= factor;
    for (SceneModel& model : scene.models)
      for (Eigen::Vector3f& p : model.mesh.vertices) p *= factor;
    scene.camera.world_from_camera.translation() *= factor;
    scene.workspace = Workspace{scene.workspace->x_min * factor, scene.workspace->x_max * factor,
                                scene.workspace->y_min * factor, scene.workspace->y_max * factor};
    settings.candidates.cost.delta *= factor;
    settings.candidates.grid.resolution *= factor;
    settings.candidates.refine.robust_scale *= factor;
    settings.candidates.refine.occlusion *= factor;
    settings.tree.depth_tolerance *= factor;
    settings.candidates.collision.penetration *= factor;
    EXPECT_TRUE(localize(scene, settings, executor, StopCondition()).search_cost);
  }
}

TEST(Localize, SaysWhichObjectHasNoPose) {
  SimulatedScene simulated = random_tabletop(71, clean(2, 160, 120));
  simulated.scene.workspace = Workspace{50.0, 50.1, 50.0, 50.1};  // far out of view
  const SerialExecutor executor;
  const Result result = localize(simulated.scene, quick(), executor, StopCondition());
  EXPECT_EQ(result.status, Status::infeasible);
  EXPECT_NE(result.reason.find("has no valid pose"), std::string::npos);
  EXPECT_FALSE(result.search_cost);
}

TEST(Localize, EstimatesTheTableFromTheLowestPoints) {
  for (std::uint64_t seed = 81; seed <= 86; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    TabletopOptions options = clean(4);
    options.noise = true;
    Scene scene = random_tabletop(seed, options).scene;
    scene.table_height.reset();
    EXPECT_NEAR(table_height(scene), 0.0, 0.01);
  }
}

}  // namespace
}  // namespace perch
