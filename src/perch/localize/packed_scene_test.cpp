#include "perch/localize/packed_scene.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "perch/candidates/packed_candidate.hpp"
#include "perch/core/random.hpp"

namespace perch {
namespace {

Eigen::Isometry3d random_transform(Random& random) {
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 16; ++i) transform.data()[i] = random.uniform(-1.0, 1.0);
  return transform;
}

Scene any_scene(std::uint64_t seed) {
  Random random(seed);
  Scene scene;
  scene.name = std::string(random.below(300), 'n');
  const int width = 1 + static_cast<int>(random.below(20)), height = 1 + static_cast<int>(random.below(20));
  scene.camera = {{width, height, 500.0 + random.uniform(), 499.0, 1.0 / 3.0, 0.1}, random_transform(random)};
  scene.depth = DepthImage(width, height);
  for (std::size_t i = 0; i < scene.depth.size(); ++i)
    scene.depth[i] = static_cast<float>(random.uniform(0.0, 3.0));
  if (random.below(2) == 0) {
    scene.mask.emplace(width, height);
    for (std::size_t i = 0; i < scene.mask->size(); ++i)
      (*scene.mask)[i] = static_cast<std::uint8_t>(random.below(256));
  }
  scene.clutter = random.below(2) == 0;
  if (random.below(2) == 0) scene.table_height = random.uniform(-1.0, 1.0);
  if (random.below(2) == 0) scene.workspace = Workspace{-0.1, random.uniform(), 0.2, 1.0 / 7.0};
  const std::size_t models = 1 + random.below(4);
  for (std::size_t m = 0; m < models; ++m) {
    SceneModel model;
    model.name = "model " + std::to_string(m);
    for (std::size_t i = random.below(50) + 3; i > 0; --i)
      model.mesh.vertices.push_back(
          Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform()).cast<float>());
    for (std::uint32_t i = 0; i + 2 < model.mesh.vertices.size(); ++i)
      model.mesh.triangles.push_back({i, i + 1, i + 2});
    if (random.below(2) == 0)
      model.symmetry = Symmetry::n_fold(1 + static_cast<int>(random.below(8)));
    else
      model.symmetry = Symmetry::continuous();
    model.base = random.uniform();
    model.rest_pose = static_cast<int>(random.below(3));
    model.stood_from_model = random_transform(random);
    model.up = {random.uniform(), random.uniform(), random.uniform()};
    scene.models.push_back(model);
    scene.objects.emplace_back(m, random.below(2) == 0);
  }
  return scene;
}

void expect_same(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.camera.intrinsics.fx, b.camera.intrinsics.fx);
  EXPECT_EQ(a.camera.intrinsics.cx, b.camera.intrinsics.cx);
  EXPECT_EQ(a.camera.intrinsics.width, b.camera.intrinsics.width);
  EXPECT_EQ(a.camera.world_from_camera.matrix(), b.camera.world_from_camera.matrix());
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.mask, b.mask);
  EXPECT_EQ(a.clutter, b.clutter);
  EXPECT_EQ(a.table_height, b.table_height);
  ASSERT_EQ(a.workspace.has_value(), b.workspace.has_value());
  if (a.workspace) {
    EXPECT_EQ(a.workspace->x_max, b.workspace->x_max);
    EXPECT_EQ(a.workspace->y_max, b.workspace->y_max);
  }
  EXPECT_EQ(a.objects, b.objects);
  ASSERT_EQ(a.models.size(), b.models.size());
  for (std::size_t m = 0; m < a.models.size(); ++m) {
    EXPECT_EQ(a.models[m].name, b.models[m].name);
    EXPECT_EQ(a.models[m].mesh.vertices, b.models[m].mesh.vertices);
    EXPECT_EQ(a.models[m].mesh.triangles, b.models[m].mesh.triangles);
    EXPECT_EQ(a.models[m].symmetry, b.models[m].symmetry);
    EXPECT_EQ(a.models[m].base, b.models[m].base);
    EXPECT_EQ(a.models[m].rest_pose, b.models[m].rest_pose);
    EXPECT_EQ(a.models[m].stood_from_model.matrix(), b.models[m].stood_from_model.matrix());
    EXPECT_EQ(a.models[m].up, b.models[m].up);
  }
}

TEST(PackedScene, ArrivesAsItWasOrIsSeenToBeCutOff) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Scene scene = any_scene(seed);
    ByteWriter to;
    write_scene(to, scene);
    ByteReader from(to.bytes());
    expect_same(read_scene(from), scene);
    EXPECT_TRUE(from.done());
    Bytes cut = to.take();
    cut.resize(Random(seed).below(cut.size()));
    ByteReader short_one(cut);
    EXPECT_THROW(read_scene(short_one), std::runtime_error);
  }
}

TEST(PackedSettings, ArriveWithEveryField) {
  Settings settings;
  settings.candidates.cost.delta = 1.0 / 3.0;
  settings.max_expansions = 12345;
  settings.mode = CandidateMode::context;
  ByteWriter to;
  write_settings(to, settings);
  ByteReader from(to.bytes());
  const Settings again = read_settings(from);
  EXPECT_TRUE(from.done());
  for (const SettingsField& field : settings_fields()) EXPECT_EQ(field.get(again), field.get(settings));
  EXPECT_EQ(again.candidates.cost.delta, 1.0 / 3.0);
}

std::vector<Run> random_runs(Random& random) {
  std::vector<Run> runs;
  auto at = static_cast<std::uint32_t>(random.below(100));
  for (std::size_t n = random.below(40); n > 0; --n) {
    const auto last = at + 1 + static_cast<std::uint32_t>(random.below(300));
    runs.push_back({at, last});
    at = last + 1 + static_cast<std::uint32_t>(random.below(20000));
  }
  return runs;
}

void expect_same(const std::vector<Run>& a, const std::vector<Run>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].first, b[i].first);
    EXPECT_EQ(a[i].last, b[i].last);
  }
}

TEST(PackedCandidate, ArrivesWithItsSets) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    Candidate candidate;
    candidate.model = random.below(300);
    candidate.pose = {random.uniform(), random.uniform(-1.0, 0.0), 1.0 / 3.0};
    candidate.window = {0, 3, static_cast<int>(random.below(16384)), 16384};
    candidate.points = static_cast<std::int64_t>(random.below(1000000));
    candidate.unexplained = 1;
    candidate.exposed = 200;
    candidate.explained_count = 300;
    candidate.explained_runs = random_runs(random);
    candidate.explained = PointSet(candidate.explained_runs);
    candidate.certain_runs = random_runs(random);
    candidate.uncertain_runs = random_runs(random);
    candidate.explained_pixels = random_runs(random);
    candidate.enclosed = PointSet(random_runs(random));
    candidate.reached = PointSet(random_runs(random));
    ByteWriter to;
    write_candidate(to, candidate);
    ByteReader from(to.bytes());
    const Candidate again = read_candidate(from);
    EXPECT_TRUE(from.done());
    EXPECT_EQ(again.model, candidate.model);
    EXPECT_EQ(again.pose, candidate.pose);
    EXPECT_EQ(again.window, candidate.window);
    EXPECT_EQ(again.points, candidate.points);
    EXPECT_EQ(again.unexplained, candidate.unexplained);
    EXPECT_EQ(again.exposed, candidate.exposed);
    EXPECT_EQ(again.explained_count, candidate.explained_count);
    expect_same(again.explained_runs, candidate.explained_runs);
    expect_same(again.explained.runs(), candidate.explained.runs());
    expect_same(again.certain_runs, candidate.certain_runs);
    expect_same(again.uncertain_runs, candidate.uncertain_runs);
    expect_same(again.explained_pixels, candidate.explained_pixels);
    expect_same(again.enclosed.runs(), candidate.enclosed.runs());
    expect_same(again.reached.runs(), candidate.reached.runs());
  }
}

}  // namespace
}  // namespace perch
