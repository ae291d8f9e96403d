// Objects that may be absent: what each search answers, against enumeration of what they may choose from.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <numbers>

#include "perch/core/random.hpp"
#include "perch/localize/exhaustive.hpp"
#include "perch/localize/localize.hpp"
#include "perch/localize/scene_search.hpp"
#include "perch/sim/parametric_models.hpp"
#include "small_problem.hpp"

namespace perch {
namespace {

/// The number of a model that is in no image yet.
std::size_t add_model(Scene& scene, const std::string& name) {
  for (std::size_t m = 0; m < scene.models.size(); ++m)
    if (scene.models[m].name == name) return m;
  scene.models.push_back(household_model(name));
  return scene.models.size() - 1;
}

/// A small scene whose list of objects has been tampered with: some may be absent, some are missing from the
/// list, some are listed that are not in the image.
SimulatedScene tampered(std::uint64_t seed) {
  Random random(seed);
  SimulatedScene simulated =
      small_tabletop(seed, seed % 2 == 0, seed % 4 == 0 ? 2 : 3, /*repeats=*/seed % 3 == 0);
  Scene& scene = simulated.scene;
  for (SceneObject& object : scene.objects) object.optional = random.uniform() < 0.6;
  if (random.uniform() < 0.4) scene.objects.erase(scene.objects.begin());
  const std::size_t extra = add_model(scene, random.uniform() < 0.5 ? "can" : "bowl");
  if (scene.objects.size() < 3) scene.objects.push_back({extra, true});
  if (scene.objects.size() < 3 && random.uniform() < 0.5)
    scene.objects.push_back({extra, random.uniform() < 0.5});
  std::swap(scene.objects.front(), scene.objects[random.below(scene.objects.size())]);
  return simulated;
}

std::size_t placed_count(const Result& result) {
  return static_cast<std::size_t>(std::count_if(result.objects.begin(), result.objects.end(),
                                                [](const ObjectResult& object) { return !object.absent; }));
}

/// That the result is one of the scene's, as it says: each object in its place of the list, only optional
/// ones absent, and the costs those of what is placed.
void expect_consistent(const Scene& scene, const Settings& settings, const Result& result) {
  ASSERT_TRUE(result.search_cost);
  ASSERT_TRUE(result.cost);
  ASSERT_EQ(result.objects.size(), scene.objects.size());
  std::vector<PlacedModel> placed;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    EXPECT_EQ(result.objects[i].model, scene.models[scene.objects[i].model].name);
    if (result.objects[i].absent) {
      EXPECT_TRUE(scene.objects[i].optional) << i;
      continue;
    }
    placed.push_back({scene.objects[i].model, result.objects[i].pose});
    names.push_back(result.objects[i].model);
  }
  ASSERT_EQ(result.search_objects.size(), placed.size());
  for (std::size_t i = 0; i < placed.size(); ++i) {
    EXPECT_EQ(result.search_objects[i].model, names[i]);
    EXPECT_EQ(result.search_objects[i].pose, placed[i].pose);
  }
  const SerialExecutor executor;
  const ScoreRecord record = score(scene, {placed}, settings, executor).front();
  EXPECT_EQ(record.cost.cost, *result.search_cost);
  EXPECT_EQ(record.cost.cost, result.cost->cost);
  EXPECT_FALSE(record.collides);
}

struct Way {
  std::string name;
  SearchMethod method;
  CandidateMode mode = CandidateMode::fixed;
  bool exhaustive = false;
};

const std::vector<Way>& ways() {
  static const std::vector<Way> all{
      {"branch and bound", SearchMethod::branch_and_bound},
      {"focal", SearchMethod::focal_mha},
      {"exhaustive", SearchMethod::branch_and_bound, CandidateMode::fixed, true},
      {"exhaustive tree", SearchMethod::focal_mha, CandidateMode::fixed, true},
      {"context", SearchMethod::focal_mha, CandidateMode::context}};
  return all;
}

Result localize_by(const Way& way, const Scene& scene, Settings settings) {
  settings.method = way.method;
  settings.mode = way.mode;
  settings.exhaustive = way.exhaustive;
  const SerialExecutor executor;
  return localize(scene, settings, executor, StopCondition());
}

/// One way alone, on a problem made before; what localize does after it is left out.
SearchOutcome search_by(const Way& way, double w, SmallProblem& small) {
  Settings settings = small.settings;
  settings.w = w;
  settings.method = way.method;
  settings.mode = way.mode;
  const std::function<void(const Progress&)> nobody;
  ProgressLog log(nobody);
  const StopCondition stop;
  if (way.exhaustive) {
    const bool all = way.method == SearchMethod::branch_and_bound;
    const Enumeration found = enumerate_scenes(*small.problem, small.set, small.makers, small.executor,
                                               all ? nullptr : &settings.tree, stop);
    SearchOutcome outcome;
    if (!found.best) return outcome;
    outcome.scenes = {*found.best};
    outcome.lower_bound = found.best->cost;
    return outcome;
  }
  if (way.mode == CandidateMode::context) {
    FixedCandidates made(*small.problem, small.makers, small.executor);
    std::int64_t hypotheses = 0;
    SearchOutcome outcome = search_in_context(*small.problem, made, small.makers, {}, settings,
                                              small.executor, stop, log, hypotheses);
    if (!outcome.scenes.empty()) {
      EXPECT_EQ(
          outcome.scenes.front().cost,
          scene_cost(*small.problem, made.set(), outcome.scenes.front().candidates, small.makers.front()));
    }
    return outcome;
  }
  FixedCandidates candidates = *small.refined;
  return search_fixed(*small.problem, candidates, small.makers, {}, settings, small.executor, stop, log);
}

TEST(OptionalObjectsHeavy, EverySearchFindsTheEnumeratedOptimum) {
  int absent = 0, optional_placed = 0, dearer = 0, in_context = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    const SimulatedScene simulated = tampered(seed);
    const Scene& scene = simulated.scene;
    // Where nothing is refined, candidates made in context are the grid's own poses: all ways have one set.
    Settings settings = small_settings(seed % 2 == 0 ? RefineMethod::none : RefineMethod::icp);
    settings.candidates.grid.yaw_resolution = seed % 4 == 0 ? 3.2 : 2.0 * std::numbers::pi;
    settings.w = 1.0;
    SmallProblem small(simulated, settings);
    const Enumerated expected = enumerate(small);
    dearer += expected.best < expected.best_in_tree;
    for (const Way& way : ways())
      for (const double w : {1.0, 1.3, 3.0}) {
        // In context every rendering is made anew, so only for small sets.
        if (way.mode == CandidateMode::context &&
            (settings.candidates.refine.method == RefineMethod::icp || small.set.size() > 42 || w == 1.3))
          continue;
        in_context += way.mode == CandidateMode::context;
        if (way.exhaustive && w > 1.0) continue;
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << way.name << ", w " << w);
        const SearchOutcome found = search_by(way, w, small);
        const std::int64_t best =
            way.method == SearchMethod::branch_and_bound ? expected.best : expected.best_in_tree;
        ASSERT_EQ(found.scenes.empty(), best == none);
        if (best == none) continue;
        const std::int64_t cost = found.scenes.front().cost;
        EXPECT_GE(cost, best);
        EXPECT_LE(static_cast<double>(cost), w * static_cast<double>(best));
        EXPECT_LE(static_cast<double>(cost), w * static_cast<double>(found.lower_bound));
        EXPECT_LE(found.lower_bound, best);
      }
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Result result = localize_by(ways()[seed % 2], scene, settings);
    const std::int64_t best = seed % 2 == 0 ? expected.best : expected.best_in_tree;
    ASSERT_NE(best, none);
    EXPECT_EQ(result.status, Status::solved);
    EXPECT_EQ(result.search_cost, best);
    EXPECT_EQ(result.lower_bound, best);
    expect_consistent(scene, settings, result);
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      absent += result.objects[i].absent;
      optional_placed += scene.objects[i].optional && !result.objects[i].absent;
    }
  }
  EXPECT_GT(absent, 5);
  EXPECT_GT(optional_placed, 5);
  EXPECT_GT(dearer, 0) << "the monotone order matters somewhere";
}

/// At 160 x 120, without noise, 6 cm and 45 degrees.
SimulatedScene clean_scene(std::uint64_t seed, const std::vector<std::string>& models, int objects) {
  TabletopOptions options;
  options.min_objects = options.max_objects = objects;
  options.models = models;
  options.repeats = models.size() == 1;
  options.noise = false;
  options.width = 160;
  options.height = 120;
  options.least_visible = 0.4;
  return random_tabletop(seed, options);
}

Settings clean_settings() {
  Settings settings;
  settings.candidates.grid.resolution = 0.06;
  settings.candidates.grid.yaw_resolution = 0.7854;
  settings.w = 1.0;
  settings.polish.rounds = 0;
  settings.ambiguity.trials = 0;
  return settings;
}

bool near_truth(const Scene& scene, const ObjectResult& object) {
  return std::any_of(scene.truth.begin(), scene.truth.end(), [&](const TruthPose& truth) {
    return scene.models[truth.model].name == object.model &&
           std::hypot(truth.pose.x - object.pose.x, truth.pose.y - object.pose.y) < 0.01;
  });
}

TEST(OptionalObjectsHeavy, AreAbsentWhereTheImageDoesNotShowThem) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SimulatedScene simulated = clean_scene(seed, {"can", "carton"}, 2);
    Scene& scene = simulated.scene;
    scene.objects = {{scene.objects[0].model, true},
                     {add_model(scene, "jar"), true},
                     {scene.objects[1].model, false},
                     {add_model(scene, "bowl"), true}};
    for (const SearchMethod method : {SearchMethod::branch_and_bound, SearchMethod::focal_mha}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << " method " << name(method));
      const Result result = localize_by({"", method}, scene, clean_settings());
      EXPECT_EQ(result.status, Status::solved);
      expect_consistent(scene, clean_settings(), result);
      ASSERT_EQ(result.objects.size(), 4U);
      EXPECT_TRUE(near_truth(scene, result.objects[0]));
      EXPECT_TRUE(result.objects[1].absent);
      EXPECT_TRUE(near_truth(scene, result.objects[2]));
      EXPECT_TRUE(result.objects[3].absent);
    }
  }
}

// [can, can (optional)], and [can (optional), can (optional)], with one can in the image and with two.
TEST(OptionalObjectsHeavy, CopiesOfAModelAreAsManyAsAreSeen) {
  for (const int seen : {1, 2})
    for (const bool both_optional : {true, false}) {
      SCOPED_TRACE(testing::Message() << seen << " in the image, both optional " << both_optional);
      SimulatedScene simulated = clean_scene(7, {"can"}, seen);
      Scene& scene = simulated.scene;
      scene.objects = {{0, true}, {0, both_optional}};
      const Result result = localize_by(ways().front(), scene, clean_settings());
      expect_consistent(scene, clean_settings(), result);
      EXPECT_EQ(placed_count(result), static_cast<std::size_t>(seen));
      for (const ObjectResult& object : result.objects)
        EXPECT_TRUE(object.absent || near_truth(scene, object));
      if (both_optional && seen == 1) {
        EXPECT_TRUE(result.objects[1].absent) << "those placed come first";
      }
    }
}

// Nothing to be seen where objects may stand: leaving all out costs |I|, and anything else costs more.
TEST(OptionalObjects, AllAreAbsentInAnEmptyPartOfTheImage) {
  TabletopOptions options;
  options.min_objects = options.max_objects = 2;
  options.models = {"can"};
  options.noise = false;
  options.width = 80;
  options.height = 60;
  options.workspace = {-0.22, -0.08, -0.16, 0.16};
  Scene scene = random_tabletop(3, options).scene;
  add_model(scene, "jar");
  scene.objects = {{0, true}, {1, true}, {0, true}};
  Settings settings = small_settings(RefineMethod::icp);
  settings.w = 1.0;
  const Workspace in_view{0.12, 0.2, -0.1, 0.1}, out_of_view{50.0, 50.1, 50.0, 50.1};
  for (const Workspace& workspace : {in_view, out_of_view})
    for (const Way& way : ways()) {
      SCOPED_TRACE(testing::Message() << way.name << ", x from " << workspace.x_min);
      scene.workspace = workspace;
      const Result result = localize_by(way, scene, settings);
      EXPECT_EQ(result.status, Status::solved);
      expect_consistent(scene, settings, result);
      EXPECT_EQ(placed_count(result), 0U);
      EXPECT_GT(result.observed_points, 0);
      EXPECT_EQ(result.search_cost, result.observed_points);
      EXPECT_EQ(result.lower_bound, result.observed_points);
      EXPECT_EQ(result.cost->cost_rendered, 0);
    }
}

// One that must be there can't be left out.
TEST(OptionalObjects, OthersMustBePlaced) {
  Scene scene = small_tabletop(1, false, 2, true).scene;
  scene.workspace = Workspace{50.0, 50.1, 50.0, 50.1};
  scene.objects = {{0, true}, {0, false}};
  for (const Way& way : ways()) {
    SCOPED_TRACE(way.name);
    const Result result = localize_by(way, scene, small_settings(RefineMethod::none));
    EXPECT_EQ(result.status, Status::infeasible);
    EXPECT_NE(result.reason.find("has no valid pose"), std::string::npos) << result.reason;
  }
}

}  // namespace
}  // namespace perch
