#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <numeric>

#include "perch/baselines/bfwor.hpp"
#include "perch/baselines/joint_selection.hpp"
#include "perch/baselines/model_cloud.hpp"
#include "perch/core/random.hpp"
#include "perch/localize/given_poses.hpp"
#include "perch/localize/localize.hpp"
#include "perch/sim/scene_generator.hpp"
#ifdef PERCH_HAS_PPF
#include "perch/baselines/ppf.hpp"
#endif

// What others do on the same input, on simulated scenes of which the truth is known.
namespace perch {
namespace {

SimulatedScene tabletop(std::uint64_t seed, int objects, int width, std::vector<std::string> models = {}) {
  TabletopOptions options;
  options.min_objects = options.max_objects = objects;
  options.width = width;
  options.height = 3 * width / 4;
  options.models = std::move(models);
  options.noise = false;
  options.repeats = false;
  options.least_visible = 0.6;
  return random_tabletop(seed, options);
}

BfworSettings coarse() {
  BfworSettings settings;
  settings.grid.resolution = 0.08;
  settings.grid.yaw_resolution = std::numbers::pi / 2;
  settings.refine.reach = 0.04;
  settings.samples = 60;
  return settings;
}

/// As many of the scene's objects as have a true pose of their model within 1 cm and 5 degrees.
std::size_t found(const Scene& scene, const std::vector<std::optional<Pose>>& poses) {
  std::vector<bool> used(scene.truth.size(), false);
  std::size_t count = 0;
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (std::size_t t = 0; t < used.size() && poses[i]; ++t) {
      const TruthPose& truth = scene.truth[t];
      if (used[t] || truth.model != scene.objects[i].model ||
          std::hypot(truth.pose.x - poses[i]->x, truth.pose.y - poses[i]->y) > 0.01 ||
          truth.symmetry.yaw_difference(truth.pose.yaw, poses[i]->yaw) > 5.0 * std::numbers::pi / 180.0)
        continue;
      used[t] = true;
      ++count;
      break;
    }
  return count;
}

void expect_same(const BaselineAnswer& a, const BaselineAnswer& b) {
  EXPECT_EQ(a.poses, b.poses);
  EXPECT_EQ(a.hypotheses, b.hypotheses);
}

/// ICP's fitness, every observed point looked at.
double fitness(const Scene& scene, const SceneModel& model, const Pose& pose, int samples) {
  const Observation observation(scene.camera, scene.depth, scene.mask);
  const SurfaceSamples cloud = placed(model_cloud(model.mesh, static_cast<std::size_t>(samples)), pose,
                                      table_height(scene) + model.base);
  double sum = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3f& p : observation.points())
      least = std::min(
          least,
          (scene.camera.world_from_camera * p.cast<double>() - cloud.point(i).cast<double>()).squaredNorm());
    sum += least;
  }
  return sum / static_cast<double>(cloud.size());
}

TEST(Bfwor, IsTheBestOfAllOrdersOnTheGrid) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    const Scene scene = tabletop(seed, 2, 48, {"mug", "can"}).scene;
    BfworSettings settings = coarse();
    settings.refine.method = RefineMethod::none;
    settings.samples = 30;
    const BaselineAnswer answer = bfwor(scene, settings, SerialExecutor(), StopCondition());

    // Every pose of the grid, valued point by point, and both orders.
    const PreparedScene prepared = prepare(scene, SerialExecutor(), StopCondition());
    std::int64_t hypotheses = 0;
    std::vector<std::vector<std::pair<double, Pose>>> fitted;
    for (std::size_t object = 0; object < 2; ++object) {
      const std::size_t model = scene.objects[object].model;
      const PoseGrid grid(prepared.workspaces[model], settings.grid, scene.models[model].symmetry);
      auto& poses = fitted.emplace_back();
      for (std::int64_t i = 0; i < static_cast<std::int64_t>(grid.size()); ++i)
        poses.emplace_back(fitness(scene, scene.models[model], grid.pose(i), settings.samples), grid.pose(i));
      if (object == 0 || model != scene.objects[0].model)
        hypotheses += static_cast<std::int64_t>(poses.size());
    }
    EXPECT_EQ(answer.hypotheses, hypotheses);
    const auto best_free = [&](std::size_t object, const Pose* other) {
      std::pair<double, Pose> best{std::numeric_limits<double>::infinity(), {}};
      for (const auto& [misfit, pose] : fitted[object])
        if (misfit < best.first && (other == nullptr || !prepared.collide(scene.objects[object].model, pose,
                                                                          scene.objects[1 - object].model,
                                                                          *other, settings.collision)))
          best = {misfit, pose};
      return best;
    };
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t first : {std::size_t{0}, std::size_t{1}}) {
      const auto placed_first = best_free(first, nullptr);
      least = std::min(least, placed_first.first + best_free(1 - first, &placed_first.second).first);
    }
    ASSERT_TRUE(answer.poses[0] && answer.poses[1]);
    double sum = 0.0;
    for (std::size_t i = 0; i < 2; ++i)
      sum += fitness(scene, scene.models[scene.objects[i].model], *answer.poses[i], settings.samples);
    EXPECT_NEAR(sum, least, 1e-5 * least);
  }
}

TEST(Bfwor, FindsAnObjectAloneByWhatIsSeenOfIt) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    SCOPED_TRACE(seed);
    const Scene scene = tabletop(seed, 1, 160, {"carton", "drill"}).scene;
    BfworSettings settings;
    settings.distance_limit = 0.005;
    EXPECT_EQ(found(scene, bfwor(scene, settings, ThreadExecutor(2), StopCondition()).poses), 1U);
  }
}

TEST(Bfwor, IsTheSameAtAnyNumberOfThreads) {
  const Scene scene = tabletop(21, 3, 80).scene;
  expect_same(bfwor(scene, coarse(), SerialExecutor(), StopCondition()),
              bfwor(scene, coarse(), ThreadExecutor(3), StopCondition()));
}

TEST(Bfwor, StopsWhenTheClockStrikes) {
  const Scene scene = tabletop(21, 3, 80).scene;
  StopCondition stop;
  stop.cancel();
  EXPECT_THROW(bfwor(scene, coarse(), SerialExecutor(), stop), Interrupted);
}

/// Proposals for joint selection: the truth, and others.
struct Proposals {
  Scene scene;
  SerialExecutor executor;
  PreparedScene prepared;
  DeltaIndex index;
  ExplanationCost cost;
  RefineSettings refine;
  PoseAligner aligner;
  std::vector<ProposedPose> proposed;

  explicit Proposals(std::uint64_t seed)
      : scene(tabletop(seed, 3, 160).scene),
        prepared(prepare(scene, executor, StopCondition())),
        index(prepared.observation, 0.005, executor),
        cost(prepared.observation, index, CostSettings{}),
        aligner(prepared, refine, executor, StopCondition()) {
    refine.method = RefineMethod::none;
    Random random(seed);
    for (const TruthPose& truth : scene.truth) {
      proposed.push_back({truth.model, truth.pose});
      for (int i = 0; i < 8; ++i) {
        const Workspace& w = prepared.workspaces[truth.model];
        proposed.push_back({truth.model, prepared.admitted(truth.model, {random.uniform(w.x_min, w.x_max),
                                                                         random.uniform(w.y_min, w.y_max),
                                                                         random.uniform(-3.0, 3.0)})});
      }
    }
  }
  Proposals(const Proposals&) = delete;

  std::int64_t cost_of(const std::vector<std::optional<Pose>>& poses) const {
    std::vector<PlacedModel> placed;
    for (std::size_t i = 0; i < poses.size(); ++i)
      if (poses[i]) placed.push_back({scene.objects[i].model, *poses[i]});
    return score(scene, {placed}, Settings(), executor).front().cost.cost;
  }
};

TEST(JointSelection, PicksTheTruthAmongOthers) {
  for (const std::uint64_t seed : {31U, 32U, 33U}) {
    SCOPED_TRACE(seed);
    const Proposals p(seed);
    const JointSelection selection =
        select_jointly(p.prepared, p.cost, {}, p.aligner, p.proposed, p.executor, StopCondition());
    EXPECT_TRUE(selection.complete);
    EXPECT_EQ(found(p.scene, selection.poses), p.scene.objects.size());
    EXPECT_EQ(selection.cost, p.cost_of(selection.poses)) << "J as `perch score` counts it";
  }
}

TEST(JointSelection, ObjectsOfWhichNothingIsProposedGetNoPose) {
  Proposals p(34);
  const std::size_t without = p.scene.objects.back().model;
  std::erase_if(p.proposed, [&](const ProposedPose& proposed) { return proposed.model == without; });
  const JointSelection selection =
      select_jointly(p.prepared, p.cost, {}, p.aligner, p.proposed, p.executor, StopCondition());
  for (std::size_t i = 0; i < selection.poses.size(); ++i)
    EXPECT_EQ(selection.poses[i].has_value(), p.scene.objects[i].model != without);
  EXPECT_EQ(selection.cost, p.cost_of(selection.poses));
}

TEST(GivenPoses, AreReportedWithoutABound) {
  const Scene scene = tabletop(41, 3, 160).scene;
  Settings settings;
  settings.localization = LocalizationMethod::bfwor;
  std::vector<std::optional<Pose>> poses;
  std::vector<PlacedModel> placed;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto truth = std::find_if(scene.truth.begin(), scene.truth.end(),
                                    [&](const TruthPose& t) { return t.model == scene.objects[i].model; });
    poses.push_back(i == 1 ? std::nullopt : std::optional(truth->pose));
    if (poses.back()) placed.push_back({scene.objects[i].model, *poses.back()});
  }
  const Result result = report_given_poses(scene, poses, false, settings, SerialExecutor());
  EXPECT_EQ(result.method, "bfwor");
  EXPECT_EQ(result.status, Status::unproven);
  EXPECT_FALSE(result.has_bound());
  EXPECT_FALSE(result.search_cost);
  EXPECT_FALSE(result.suboptimality_bound());
  ASSERT_EQ(result.objects.size(), 3U);
  EXPECT_TRUE(std::count_if(result.objects.begin(), result.objects.end(),
                            [](const ObjectResult& o) { return o.absent; }) == 1);
  EXPECT_EQ(result.cost->cost, score(scene, {placed}, settings, SerialExecutor()).front().cost.cost);

  const Result nothing = report_given_poses(scene, {}, true, settings, SerialExecutor());
  EXPECT_EQ(nothing.status, Status::time_limit);
  EXPECT_FALSE(nothing.cost);
  EXPECT_TRUE(nothing.objects.empty());
  EXPECT_EQ(nothing.observed_points, result.observed_points);
}

#ifdef PERCH_HAS_PPF

TEST(Ppf, FindsObjectsThatAreInView) {
  for (const std::uint64_t seed : {51U}) {
    SCOPED_TRACE(seed);
    const Scene scene = tabletop(seed, 2, 320, {"drill", "mug"}).scene;
    const BaselineAnswer answer = ppf(scene, {}, ThreadExecutor(2), StopCondition());
    EXPECT_EQ(found(scene, answer.poses), 2U);
    EXPECT_FALSE(answer.stopped);
    EXPECT_GT(answer.hypotheses, 0);
  }
}

TEST(Ppf, IsTheSameAtAnyNumberOfThreads) {
  const Scene scene = tabletop(53, 2, 160, {"drill", "mug"}).scene;
  expect_same(ppf(scene, {}, SerialExecutor(), StopCondition()),
              ppf(scene, {}, ThreadExecutor(3), StopCondition()));
}

#endif

}  // namespace
}  // namespace perch
