// Every pixel against brute force: objects rendered one by one, all pairs of points compared.

#include "perch/localize/rendering.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "perch/core/error.hpp"
#include "perch/core/random.hpp"
#include "perch/localize/localize.hpp"
#include "perch/render/rasterizer.hpp"

namespace perch {
namespace {

/// A closed box on z = 0 around the z axis.
Mesh box(float length, float width, float height) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back((i & 1 ? 0.5F : -0.5F) * length, (i & 2 ? 0.5F : -0.5F) * width,
                               i & 4 ? height : 0.0F);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// A camera one metre up that looks straight down.
Camera camera_from_above(int width, int height, double focal) {
  Camera camera;
  camera.intrinsics = {width, height, focal, focal, (width - 1) / 2.0, (height - 1) / 2.0};
  camera.world_from_camera.linear() = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  camera.world_from_camera.translation() = Eigen::Vector3d(0.0, 0.0, 1.0);
  return camera;
}

struct TestScene {
  Scene scene;
  std::vector<PlacedModel> placed;
  Settings settings;
};

DepthPatch render_one(const Scene& scene, const PlacedModel& object) {
  const SceneModel& model = scene.models[object.model];
  return Rasterizer(scene.camera.intrinsics)
      .render(model.mesh, scene.camera.world_from_camera.inverse() *
                              world_from_model(object.pose, *scene.table_height + model.base));
}

/// Boxes seen from above, noisy and full of holes, and the same boxes placed a little off.
TestScene random_scene(std::uint64_t seed) {
  Random random(seed);
  TestScene test;
  Scene& scene = test.scene;
  const int width = 8 + static_cast<int>(random.below(30)), height = 8 + static_cast<int>(random.below(25));
  scene.camera = camera_from_above(width, height, random.uniform(30, 90));
  scene.table_height = random.uniform(-0.1, 0.1);
  scene.depth = DepthImage(width, height);
  const auto side = [&] { return static_cast<float>(random.uniform(0.05, 0.3)); };
  for (const char* name : {"one", "two"})
    scene.models.push_back({name, box(side(), side(), side()), Symmetry::none(), random.uniform(0.0, 0.05)});
  const std::size_t objects = random.below(5);
  for (std::size_t i = 0; i < objects; ++i) {
    PlacedModel truth{
        random.below(2),
        {random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(0, 2 * std::numbers::pi)}};
    const DepthPatch patch = render_one(scene, truth);
    for (int v = patch.window.v0; v < patch.window.v1; ++v)
      for (int u = patch.window.u0; u < patch.window.u1; ++u)
        if (random.uniform() < 0.8 && patch.at(u, v) < no_surface)
          scene.depth(u, v) = patch.at(u, v) + static_cast<float>(0.004 * random.normal());
    truth.pose.x += 0.02 * random.normal();
    truth.pose.yaw += 0.2 * random.normal();
    test.placed.push_back(truth);
  }
  scene.depth(width / 2, height / 2) = 0.8F;  // something is always observed
  if (random.uniform() < 0.7) {
    scene.mask = Image<std::uint8_t>(width, height);
    for (std::size_t i = 0; i < scene.mask->size(); ++i) (*scene.mask)[i] = random.uniform() < 0.9;
    (*scene.mask)(width / 2, height / 2) = 1;
  }
  test.settings.candidates.cost.delta = random.uniform(0.004, 0.04);
  if (random.uniform() < 0.5) test.settings.candidates.cost.missing_depth = MissingDepth::ignore;
  return test;
}

/// The same images straight from the definitions.
SceneRendering brute_force(const TestScene& test) {
  const Scene& scene = test.scene;
  const int width = scene.depth.width(), height = scene.depth.height();
  const auto delta = static_cast<float>(test.settings.candidates.cost.delta);
  const bool ignore = test.settings.candidates.cost.missing_depth == MissingDepth::ignore;
  const Image<std::uint8_t> unset(width, height, 0);
  SceneRendering expected{DepthImage(width, height),
                          Image<std::uint32_t>(width, height, SceneRendering::no_object),
                          unset,
                          unset,
                          unset,
                          unset,
                          {}};
  std::vector<DepthPatch> patches;
  for (const PlacedModel& object : test.placed) patches.push_back(render_one(scene, object));
  struct Point {
    int u, v;
    Eigen::Vector3f point;
  };
  std::vector<Point> observed, rendered;
  const RaySlopes rays(scene.camera.intrinsics);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const float z = scene.depth(u, v);
      if (z > 0 && (!scene.mask || (*scene.mask)(u, v))) observed.push_back({u, v, rays.point(u, v, z)});
      float nearest = no_surface;
      for (std::size_t i = patches.size(); i-- > 0;)  // backwards: of equals the first is seen
        if (const float depth = patches[i].at_or_none(u, v); depth < no_surface && depth <= nearest) {
          nearest = depth;
          expected.object(u, v) = static_cast<std::uint32_t>(i);
        }
      if (!(nearest < no_surface)) continue;
      expected.depth(u, v) = nearest;
      expected.left_out(u, v) = ignore && scene.mask && !(z > 0);
      if (!expected.left_out(u, v)) rendered.push_back({u, v, rays.point(u, v, nearest)});
    }
  const auto lonely = [&](const Point& p, const std::vector<Point>& cloud) {
    for (const Point& q : cloud) {
      const float dx = p.point.x() - q.point.x(), dy = p.point.y() - q.point.y(),
                  dz = p.point.z() - q.point.z();
      if (dx * dx + dy * dy + dz * dz <= delta * delta) return false;
    }
    return true;
  };
  for (const Point& p : observed) {
    expected.observed(p.u, p.v) = 1;
    expected.observed_unexplained(p.u, p.v) = lonely(p, rendered);
    expected.cost.cost_observed += lonely(p, rendered);
  }
  for (const Point& p : rendered) {
    expected.rendered_unexplained(p.u, p.v) = lonely(p, observed);
    expected.cost.cost_rendered += lonely(p, observed);
  }
  return expected;
}

TEST(SceneRendering, EqualsBruteForceOnRandomScenes) {
  const auto executor = make_executor(3);
  std::int64_t observed = 0, rendered = 0, left_out = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const TestScene test = random_scene(seed);
    const SceneRendering actual = render_scene(test.scene, test.placed, test.settings, *executor);
    const SceneRendering expected = brute_force(test);
    ASSERT_EQ(actual.depth, expected.depth);
    ASSERT_EQ(actual.object, expected.object);
    ASSERT_EQ(actual.observed, expected.observed);
    ASSERT_EQ(actual.observed_unexplained, expected.observed_unexplained);
    ASSERT_EQ(actual.rendered_unexplained, expected.rendered_unexplained);
    ASSERT_EQ(actual.left_out, expected.left_out);
    ASSERT_EQ(actual.cost.cost_observed, expected.cost.cost_observed);
    ASSERT_EQ(actual.cost.cost_rendered, expected.cost.cost_rendered);
    ASSERT_EQ(actual.cost.cost, actual.cost.cost_observed + actual.cost.cost_rendered);
    observed += actual.cost.cost_observed;
    rendered += actual.cost.cost_rendered;
    left_out += std::count(actual.left_out.data().begin(), actual.left_out.data().end(), 1);
  }
  // The scenes hold some of everything.
  EXPECT_GT(observed, 1000);
  EXPECT_GT(rendered, 1000);
  EXPECT_GT(left_out, 100);
}

TEST(SceneRendering, CountsWhatScoreCounts) {
  const SerialExecutor executor;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    TestScene test = random_scene(seed);
    test.scene.objects = {0};  // scoring asks for a problem with at least one object
    if (seed % 2 == 0) test.scene.table_height.reset();  // both estimate the same one
    const SceneRendering rendering = render_scene(test.scene, test.placed, test.settings, executor);
    const CostRecord scored = score(test.scene, {test.placed}, test.settings, executor)[0].cost;
    EXPECT_EQ(rendering.cost.cost_observed, scored.cost_observed);
    EXPECT_EQ(rendering.cost.cost_rendered, scored.cost_rendered);
    EXPECT_EQ(rendering.cost.cost, scored.cost);
  }
}

TEST(SceneRendering, ShowsTheFirstOfTwoAtTheSameDepth) {
  TestScene test = random_scene(1);
  test.placed = {{0, {0.05, 0.0, 0.3}}, {0, {0.05, 0.0, 0.3}}};
  const SceneRendering rendering = render_scene(test.scene, test.placed, test.settings, SerialExecutor());
  std::int64_t seen = 0;
  for (int v = 0; v < rendering.depth.height(); ++v)
    for (int u = 0; u < rendering.depth.width(); ++u) {
      ASSERT_EQ(rendering.object_at(u, v).has_value(), rendering.depth(u, v) > 0.0F);
      if (!rendering.object_at(u, v)) continue;
      ASSERT_EQ(*rendering.object_at(u, v), 0U);
      ++seen;
    }
  EXPECT_GT(seen, 0);
}

TEST(SceneRendering, TakesTheObjectsOfAResultByName) {
  const TestScene test = random_scene(2);
  Result result;
  for (const char* name : {"two", "one"}) {
    ObjectResult object;
    object.model = name;
    object.pose = {0.1, 0.2, 0.3};
    result.objects.push_back(object);
  }
  const std::vector<PlacedModel> placed = placed_objects(test.scene, result);
  ASSERT_EQ(placed.size(), 2U);
  EXPECT_EQ(placed[0].model, 1U);
  EXPECT_EQ(placed[1].model, 0U);
  EXPECT_EQ(placed[1].pose, (Pose{0.1, 0.2, 0.3}));
  result.objects[0].model = "three";
  EXPECT_THROW(placed_objects(test.scene, result), std::logic_error);
}

TEST(SceneRendering, RefusesBadSettings) {
  TestScene test = random_scene(3);
  test.settings.candidates.cost.delta = -1.0;
  EXPECT_THROW(render_scene(test.scene, test.placed, test.settings, SerialExecutor()), InvalidSetting);
}

}  // namespace
}  // namespace perch
