// What an object can explain at most, without a rendering, against what its renderings do explain.

#include "perch/candidates/explained_bound.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "perch/core/instruction_set.hpp"
#include "perch/core/random.hpp"
#include "perch/sim/mesh_builder.hpp"
#include "perch/sim/parametric_models.hpp"
#include "small_problem.hpp"

namespace perch {
namespace {

/// Without every third triangle: no inside, and a distance field without a sign.
SceneModel opened(SceneModel model) {
  std::vector<std::array<std::uint32_t, 3>> left;
  for (std::size_t i = 0; i < model.mesh.triangles.size(); ++i)
    if (i % 3 != 0) left.push_back(model.mesh.triangles[i]);
  model.name += " (open)";
  model.mesh.triangles = left;
  return model;
}

/// A small scene with further models that nothing in the image shows.
Scene scene_of(std::uint64_t seed, Random& random) {
  Scene scene = small_tabletop(seed, seed % 2 == 0, 3, false).scene;
  for (const char* name : {"mug", "bowl", "carton", "drill"}) {
    SceneModel model = household_model(name);
    if (random.below(2) == 0) model = opened(std::move(model));
    scene.objects.push_back({scene.models.size(), false});
    scene.models.push_back(std::move(model));
  }
  if (random.below(2) == 0) add_mask(scene, random);
  return scene;
}

class ExplainedBoundTest : public testing::Test {
 protected:
  void TearDown() override { use_instruction_set(InstructionSet::x86_64_v4); }

  struct Tally {
    std::int64_t explained = 0, bound = 0, poses = 0, useful = 0, out_of_view = 0;
  };

  static std::unique_ptr<LocalizationProblem> problem_of(const Scene& scene, Random& random) {
    Settings settings = small_settings(RefineMethod::none);
    settings.candidates.cost.delta = random.uniform(0.002, 0.02);
    settings.candidates.cost.missing_depth =
        random.below(2) == 0 ? MissingDepth::unexplained : MissingDepth::ignore;
    const SerialExecutor executor;
    return make_problem(scene, settings, executor);
  }

  /// Blocks of a model at a place, the same for every instruction set.
  static std::vector<char> near(const LocalizationProblem& problem, std::size_t model,
                                const Eigen::Isometry3d& camera_from_model) {
    std::vector<std::vector<char>> all;
    for (const InstructionSet set :
         {InstructionSet::baseline, InstructionSet::x86_64_v3, InstructionSet::x86_64_v4}) {
      use_instruction_set(set);
      std::vector<char> chosen(problem.blocks().size(), 0);
      std::uint32_t end = 0;
      for (const perch::Run& run :
           problem.explained_bound().blocks(problem.models()[model], camera_from_model)) {
        EXPECT_LT(run.first, run.last);
        EXPECT_LE(end, run.first);
        EXPECT_LE(run.last, chosen.size());
        end = run.last;
        std::fill(chosen.begin() + run.first, chosen.begin() + run.last, 1);
      }
      all.push_back(chosen);
      EXPECT_EQ(all.back(), all.front());
    }
    return all.front();
  }

  /// \param explained points of I. \param window of the rendering.
  static void check(const LocalizationProblem& problem, std::size_t model,
                    const Eigen::Isometry3d& camera_from_model, const std::vector<std::uint32_t>& explained,
                    const Window& window, Tally& tally) {
    const ObjectModel& shape = problem.models()[model];
    const std::vector<char> blocks = near(problem, model, camera_from_model);
    const Window bound = problem.explained_bound().window(shape, camera_from_model);
    if (!window.empty()) {
      EXPECT_EQ(intersection(window, bound), window);
    }
    std::vector<std::int64_t> is_explained(problem.observation().size(), 0), one(is_explained.size(), 1);
    for (const std::uint32_t i : explained) is_explained[i] = 1;
    const auto explained_of = problem.blocks().sums(is_explained), points_of = problem.blocks().sums(one);
    std::int64_t most = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      if (blocks[b])
        most += points_of[b];
      else
        ASSERT_EQ(explained_of[b], 0) << "of " << points_of[b] << " points in block " << b;
    }
    if (bound.empty()) {
      EXPECT_EQ(most, 0);
    }
    ++tally.poses;
    tally.explained += static_cast<std::int64_t>(explained.size());
    tally.bound += most;
    tally.useful += most < static_cast<std::int64_t>(one.size()) / 2;
    tally.out_of_view += bound.empty();
  }
};

TEST_F(ExplainedBoundTest, HoldsWhatCandidatesExplain) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Random random(seed);
    const Scene scene = scene_of(seed, random);
    const auto problem = problem_of(scene, random);
    CandidateMaker maker(*problem);
    for (int round = 0; round < 150; ++round) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << " round " << round);
      const std::size_t model = random.below(problem->models().size());
      // Near the truth, on the table, or anywhere.
      Pose pose{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-4, 4)};
      if (round % 3 == 0) {
        const TruthPose& truth = scene.truth[random.below(scene.truth.size())];
        pose = {truth.pose.x + random.uniform(-0.02, 0.02), truth.pose.y + random.uniform(-0.02, 0.02),
                truth.pose.yaw + random.uniform(-0.3, 0.3)};
      } else if (round % 10 == 1) {
        pose = {10 * pose.x, 10 * pose.y, pose.yaw};
      }
      const auto candidate = maker.value(model, pose);
      std::vector<std::uint32_t> explained;
      if (candidate)
        for (const perch::Run& run : candidate->explained_runs)
          for (std::uint32_t i = run.first; i < run.last; ++i) explained.push_back(i);
      if (problem->window(model, pose).empty()) {
        EXPECT_FALSE(candidate);
      }
      check(*problem, model, problem->camera_from_model(model, pose), explained,
            candidate ? candidate->window : Window(), tally);
      if (HasFatalFailure()) return;
    }
  }
  RecordProperty("explained", std::to_string(tally.explained));
  RecordProperty("bound", std::to_string(tally.bound));
  EXPECT_GT(tally.explained, 3000);
  EXPECT_LT(tally.bound, 4 * tally.explained) << "a good deal of it is explained";
  EXPECT_GT(tally.useful, tally.poses / 2);
  EXPECT_GT(tally.out_of_view, 10);
}

// Any rigid motion, also through the near plane and behind the camera.
TEST_F(ExplainedBoundTest, HoldsAtAnyPlaceBeforeTheCamera) {
  Tally tally;
  int near_plane = 0;
  for (std::uint64_t seed = 101; seed <= 104; ++seed) {
    Random random(seed);
    const Scene scene = scene_of(seed, random);
    const auto problem = problem_of(scene, random);
    Rasterizer rasterizer(scene.camera.intrinsics);
    const Composite nothing = problem->cost().empty();
    CostChange change;
    DepthPatch patch;
    for (int round = 0; round < 150; ++round) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << " round " << round);
      const std::size_t model = random.below(problem->models().size());
      const auto& points = problem->observation().points();
      Eigen::Isometry3d place(
          Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
              .normalized());
      place.translation() = points[random.below(points.size())].cast<double>();
      if (round % 3 == 0)
        place.translation() = 0.15 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
      // One of its vertices at a point of I, or thereabouts.
      const auto& vertices = problem->models()[model].mesh().vertices;
      place.translation() -= place.linear() * vertices[random.below(vertices.size())].cast<double>();
      for (int i = 0; i < 3; ++i) place.translation()[i] += 0.01 * random.normal();
      rasterizer.render(problem->models()[model].mesh(), place, patch);
      problem->cost().change(nothing, patch, change);
      const Eigen::AlignedBox3d box = problem->models()[model].bounds().cast<double>();
      bool before = false, behind = false;
      for (int c = 0; c < 8; ++c) {
        const double z = (place * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(c))).z();
        (z > Rasterizer::near_plane ? before : behind) = true;
      }
      near_plane += before && behind;
      check(*problem, model, place, change.gained, patch.window, tally);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(tally.explained, 1000);
  EXPECT_GT(near_plane, 20);
}

// Where pixels are small beside delta, a point can be explained from well outside the object's image.
TEST_F(ExplainedBoundTest, HoldsPointsBesideTheImageOfTheObject) {
  Tally tally;
  int beside = 0;
  for (std::uint64_t seed = 151; seed <= 153; ++seed) {
    Random random(seed);
    Scene scene = small_tabletop(seed, false, 2, false).scene;
    scene.models = {{"box", box({0.1, 0.08, 0.05}, 0.1), Symmetry::none(), 0.0}};
    scene.objects = {{0, false}};
    scene.camera.intrinsics.fx = scene.camera.intrinsics.fy = 200.0;
    for (std::size_t i = 0; i < scene.depth.size(); ++i) scene.depth[i] = 1.0F;
    Settings settings = small_settings(RefineMethod::none);
    settings.candidates.cost.delta = 0.02;  // 4 pixels
    const SerialExecutor executor;
    const auto problem = make_problem(scene, settings, executor);
    Rasterizer rasterizer(scene.camera.intrinsics);
    CostChange change;
    for (int round = 0; round < 40; ++round) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << " round " << round);
      // The top faces the camera, so that the image fills its window.
      Eigen::Isometry3d place(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
      place.translation() = Eigen::Vector3d(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1),
                                            1.05 + random.uniform(-0.005, 0.005));
      const DepthPatch patch = rasterizer.render(problem->models()[0].mesh(), place);
      problem->cost().change(problem->cost().empty(), patch, change);
      for (const std::uint32_t i : change.gained)
        beside += !patch.window.contains(problem->observation().column(i),
                                         static_cast<int>(i) / scene.camera.intrinsics.width);
      check(*problem, 0, place, change.gained, patch.window, tally);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(beside, 1000);
}

// No renderings here: what lies far off explains nothing, and what is out of view neither.
TEST_F(ExplainedBoundTest, GivesNothingFarOff) {
  for (std::uint64_t seed = 201; seed <= 201; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Scene scene = scene_of(seed, random);
    const auto problem = problem_of(scene, random);
    for (std::size_t model = 0; model < problem->models().size(); ++model)
      for (const double angle : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0}) {
        for (const double distance : {3.0, 50.0}) {
          const Pose pose{distance * std::cos(angle), distance * std::sin(angle), angle};
          const auto blocks = near(*problem, model, problem->camera_from_model(model, pose));
          EXPECT_EQ(std::count(blocks.begin(), blocks.end(), 1), 0);
        }
        // Beside the image, at the depth of what is seen.
        Eigen::Isometry3d beside = Eigen::Isometry3d::Identity();
        beside.translation() = Eigen::Vector3d(2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.9);
        EXPECT_TRUE(problem->explained_bound().window(problem->models()[model], beside).empty());
        EXPECT_TRUE(problem->explained_bound().blocks(problem->models()[model], beside).empty());
      }
  }
}

}  // namespace
}  // namespace perch
