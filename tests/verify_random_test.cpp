// What the program counts must lie within what perch::verify allows, and that must be next to nothing wide:
// for arrangements of all kinds, seen from afar and from within.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "perch/core/random.hpp"
#include "perch/localize/localize.hpp"
#include "perch/localize/report.hpp"
#include "perch/localize/setup.hpp"
#include "perch/sim/scene_generator.hpp"
#include "verify_test_support.hpp"

namespace perch {
namespace {

struct Arrangement {
  Scene scene;
  std::vector<PlacedModel> placed;
  Settings settings;
};

/// The true arrangement of a random scene moved by anything from a tenth of a millimetre to decimetres, under
/// a random delta; the camera perhaps moved forward, up to among the objects; some pixels perhaps without a
/// reading.
Arrangement random_arrangement(std::uint64_t seed, int width, int height) {
  Random random(seed);
  TabletopOptions options;
  options.width = width;
  options.height = height;
  options.least_visible = 0.05;
  options.noise = random.uniform() < 0.7;
  Arrangement a{random_tabletop(seed, options).scene, {}, {}};
  const double spread = std::pow(10.0, random.uniform(-4.0, -0.7));
  for (const TruthPose& truth : a.scene.truth)
    a.placed.push_back({truth.model,
                        {truth.pose.x + spread * random.normal(), truth.pose.y + spread * random.normal(),
                         truth.pose.yaw + 10.0 * spread * random.normal()}});
  if (random.uniform() < 0.3)
    a.scene.camera.world_from_camera.translate(Eigen::Vector3d(0.0, 0.0, random.uniform(0.0, 1.0)));
  if (random.uniform() < 0.5) {
    a.scene.mask.emplace(width, height, 1);
    for (std::size_t i = 0; i < a.scene.depth.size(); ++i) {
      (*a.scene.mask)[i] = random.uniform() < 0.97;
      if (random.uniform() < 0.05) a.scene.depth[i] = 0.0F;
    }
  }
  if (random.uniform() < 0.2) a.scene.table_height.reset();
  CandidateSettings& settings = a.settings.candidates;
  settings.cost.delta = std::pow(10.0, random.uniform(-3.5, -1.3));
  if (random.uniform() < 0.5) settings.cost.missing_depth = MissingDepth::ignore;
  if (random.uniform() < 0.5) {
    a.scene.clutter = true;
    settings.cost.clutter_weight = random.uniform(1.0 / 64.0, 1.0);
    if (random.uniform() < 0.5) settings.cost.clutter_points = ClutterPoints::ignore;
  }
  settings.refine.method = RefineMethod::none;
  return a;
}

/// What the program says of the arrangement, as if a search had proven it the best.
Result report(const Arrangement& a, const LocalizationProblem& problem) {
  Result result;
  report_search(problem, a.placed, result);
  report_scene(problem, a.placed, result);
  result.observed_points = static_cast<std::int64_t>(problem.observation().size());
  result.search_cost = result.lower_bound = result.cost->cost;
  result.status = Status::solved;
  result.guarantee.delta = a.settings.candidates.cost.delta;
  result.guarantee.missing_depth = name(a.settings.candidates.cost.missing_depth);
  result.guarantee.clutter = clutter_of(a.scene, a.settings);
  result.guarantee.collision_penetration = a.settings.candidates.collision.penetration;
  result.guarantee.collision_overlap = a.settings.candidates.collision.overlap;
  return result;
}

void check_random_arrangements(std::uint64_t first_seed, std::uint64_t seeds, int width, int height) {
  const SerialExecutor executor;
  std::int64_t pixels = 0, widths = 0;
  for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}, {} x {}", seed, width, height));
    const Arrangement a = random_arrangement(seed, width, height);
    const auto problem = make_problem(a.scene, a.settings, executor);
    const Result result = report(a, *problem);
    const bool collides = score_scene(*problem, a.placed, a.settings.tree).collides;
    const Checks checks = testing_verify::verify_text(a.scene, to_json(result));
    for (const Check& check : checks) {
      const bool of_collision = check.name.ends_with("don't collide");
      EXPECT_TRUE(check.holds || (of_collision && collides))
          << check.name << ": " << check.reported << ", not " << check.recomputed;
    }
    for (const ObjectResult& object : result.objects) pixels += object.visible_pixels;
    widths += testing_verify::range_of(checks, "cost").width();
  }
  EXPECT_GT(pixels, 500 * static_cast<std::int64_t>(seeds));
  EXPECT_LT(widths, pixels / 500);
}

TEST(VerifyRandomScenes, HoldWhatTheProgramCounts) {
  check_random_arrangements(1, 8, 160, 120);
}

TEST(VerifyRandomScenesHeavy, HoldWhatTheProgramCounts) {
  check_random_arrangements(101, 12, 160, 120);
  check_random_arrangements(1001, 2, 640, 480);
}

}  // namespace
}  // namespace perch
