#include "perch/baselines/our_cvfh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "perch/baselines/descriptor_file.hpp"
#include "perch/baselines/icosphere.hpp"
#include "perch/baselines/object_view.hpp"
#include "perch/baselines/upright_pose.hpp"
#include "perch/core/error.hpp"
#include "perch/core/random.hpp"
#include "perch/render/rasterizer.hpp"

namespace perch {
namespace {

namespace fs = std::filesystem;

TEST(Icosphere, Has642UnitVerticesOfWhich12HaveFiveNeighbours) {
  const Icosphere sphere = icosphere(3);
  ASSERT_EQ(sphere.vertices.size(), 642U);
  for (const Eigen::Vector3d& vertex : sphere.vertices) EXPECT_NEAR(vertex.norm(), 1.0, 1e-12);
  std::map<std::uint32_t, std::set<std::uint32_t>> neighbours;
  for (const auto& triangle : sphere.triangles)
    for (const std::uint32_t a : triangle)
      for (const std::uint32_t b : triangle)
        if (a != b) neighbours[a].insert(b);
  std::map<std::size_t, int> of_valence;
  for (const auto& [vertex, others] : neighbours) ++of_valence[others.size()];
  EXPECT_EQ(of_valence, (std::map<std::size_t, int>{{5, 12}, {6, 630}}));
}

/// The six sides of a box, metres.
void add_box(Mesh& mesh, const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(),
                               i & 4 ? high.z() : low.z());
  for (const auto& [a, b, c, d] : {std::array<std::uint32_t, 4>{0, 2, 3, 1},
                                   {4, 5, 7, 6},
                                   {0, 1, 5, 4},
                                   {2, 6, 7, 3},
                                   {0, 4, 6, 2},
                                   {1, 3, 7, 5}}) {
    mesh.triangles.push_back({first + a, first + b, first + c});
    mesh.triangles.push_back({first + a, first + c, first + d});
  }
}

/// A thing that no turn maps onto itself.
Mesh odd_block() {
  Mesh mesh;
  add_box(mesh, {-0.07F, -0.035F, 0.0F}, {0.07F, 0.035F, 0.05F});
  add_box(mesh, {0.01F, -0.035F, 0.05F}, {0.07F, 0.0F, 0.11F});
  return mesh;
}

TEST(ObjectView, ShowsTheSurfaceFromTheSideAskedFor) {
  Mesh box;
  const Eigen::Vector3f low(-0.03F, 0.01F, 0.0F), high(0.05F, 0.06F, 0.1F);
  add_box(box, low, high);
  for (const Eigen::Vector3d& direction : icosphere(0).vertices) {
    const ObjectView view = view_object(box, direction, 0.6, 0.002);
    const Eigen::Isometry3d model_from_camera = view.camera_from_model.inverse();
    const Eigen::Vector3d middle = 0.5 * (low + high).cast<double>();
    EXPECT_LT((model_from_camera.translation() - (middle + 0.6 * direction)).norm(), 1e-6);
    EXPECT_LE(model_from_camera.linear()(2, 1), 1e-9) << "the image is upside down";
    ASSERT_GT(view.points.size(), 500U);
    for (const Eigen::Vector3f& seen : view.points) {
      const Eigen::Vector3f p = (model_from_camera * seen.cast<double>()).cast<float>();
      // From the nearest side, which the camera stands in front of.
      const Eigen::Array3f off = ((p - low).array().min((high - p).array())).abs();
      Eigen::Index side = 0;
      ASSERT_LT(off.minCoeff(&side), 1e-4F);
      ASSERT_TRUE((p.array() > low.array() - 1e-4F).all() && (p.array() < high.array() + 1e-4F).all());
    }
  }
}

TEST(UprightPose, UndoesASmallTilt) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Pose pose{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-3.0, 3.0)};
    const Eigen::Vector3d middle(0.01, -0.02, 0.06);
    const double angle = random.uniform(0.0, 0.3), around = random.uniform(0.0, 6.0);
    const Eigen::Isometry3d upright = world_from_model(pose, 0.0);
    // About a level axis through the middle.
    const Eigen::AngleAxisd lean(angle, Eigen::Vector3d(std::cos(around), std::sin(around), 0.0));
    const Eigen::Vector3d pivot = upright * middle;
    const Eigen::Isometry3d tilted =
        Eigen::Translation3d(pivot) * lean * Eigen::Translation3d(-pivot) * upright;
    EXPECT_NEAR(tilt(tilted), angle, 1e-6);
    const Pose found = upright_pose(tilted, middle);
    EXPECT_NEAR(angle_difference(found.yaw, pose.yaw, 2.0 * std::numbers::pi), 0.0, 1e-9);
    EXPECT_NEAR(found.x, pose.x, 1e-9);
    EXPECT_NEAR(found.y, pose.y, 1e-9);
  }
}

bool same(const TrainedModel& a, const TrainedModel& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.histogram == y.histogram && x.of_region == y.of_region &&
           x.frame_from_cloud.matrix().topRows(3) == y.frame_from_cloud.matrix().topRows(3);
  });
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

class OurCvfh : public testing::Test {
 protected:
  OurCvfh() {
    // Few views and coarse clouds, to be quick.
    settings.training.subdivisions = 1;
    settings.training.spacing = 0.003;
    DescriptorSettings& descriptor = settings.training.descriptor;
    descriptor.voxel = 0.006;
    descriptor.smoothing_radius = 0.015;
    descriptor.normal_radius = descriptor.region_gap = 0.018;
    descriptor.least_region = 10;
    settings.cluster_tolerance = 0.02;
    settings.cache =
        fs::path(testing::TempDir()) /
        (std::string("our_cvfh_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(settings.cache);
  }
  ~OurCvfh() override { fs::remove_all(settings.cache); }

  /// The block alone on the table.
  static Scene scene(const Pose& pose) {
    Scene scene;
    scene.camera.intrinsics = {320, 240, 262.5, 262.5, 159.5, 119.5};
    Eigen::Matrix4d pose_of_camera;
    pose_of_camera << 1, 0, 0, 0, 0, -0.548, 0.836, -0.733, 0, -0.836, -0.548, 0.563, 0, 0, 0, 1;
    scene.camera.world_from_camera = rigid_transform(pose_of_camera, "camera");
    scene.models.push_back({"block", odd_block(), Symmetry::none(), 0.0});
    scene.objects = {SceneObject(0)};
    scene.table_height = 0.0;
    const DepthPatch patch = Rasterizer(scene.camera.intrinsics)
                                 .render(scene.models[0].mesh, scene.camera.world_from_camera.inverse() *
                                                                   world_from_model(pose, 0.0));
    scene.depth = DepthImage(320, 240);
    for (int v = patch.window.v0; v < patch.window.v1; ++v)
      for (int u = patch.window.u0; u < patch.window.u1; ++u)
        if (patch.at(u, v) < no_surface) scene.depth(u, v) = patch.at(u, v);
    return scene;
  }

  OurCvfhSettings settings;
  StopCondition never;
};

TEST_F(OurCvfh, FindsAnObjectThatStandsAlone) {
  for (const Pose& truth : {Pose{0.05, 0.02, 0.6}, Pose{-0.06, -0.03, -2.2}}) {
    const BaselineAnswer answer = our_cvfh(scene(truth), settings, SerialExecutor(), never);
    ASSERT_EQ(answer.poses.size(), 1U);
    ASSERT_TRUE(answer.poses[0]);
    EXPECT_FALSE(answer.stopped);
    EXPECT_GT(answer.hypotheses, 0);
    EXPECT_LT(std::hypot(answer.poses[0]->x - truth.x, answer.poses[0]->y - truth.y), 0.01);
    EXPECT_LT(angle_difference(answer.poses[0]->yaw, truth.yaw, 2.0 * std::numbers::pi),
              10.0 * std::numbers::pi / 180.0);
    // From what was kept, by several threads: the same.
    EXPECT_EQ(our_cvfh(scene(truth), settings, ThreadExecutor(3), never).poses, answer.poses);
  }
}

TEST_F(OurCvfh, LeavesObjectsWithoutAPoseWhereClustersAreTooFew) {
  Scene two = scene({0.0, 0.0, 1.0});
  two.objects = {SceneObject(0), SceneObject(0)};
  const BaselineAnswer answer = our_cvfh(two, settings, SerialExecutor(), never);
  EXPECT_EQ(std::count(answer.poses.begin(), answer.poses.end(), std::nullopt), 1);
}

TEST_F(OurCvfh, StopsWhenAskedTo) {
  StopCondition stop;
  stop.cancel();
  const BaselineAnswer answer = our_cvfh(scene({}), settings, SerialExecutor(), stop);
  EXPECT_TRUE(answer.stopped);
  EXPECT_THAT(answer.poses, testing::ElementsAre(std::nullopt));
}

TEST_F(OurCvfh, LearnsTheSameFromDamagedCachesAndWithAnyThreads) {
  const Mesh mesh = odd_block();
  settings.training.subdivisions = 0;
  const TrainedModel learned = train(mesh, settings.training, SerialExecutor(), never);
  EXPECT_GE(learned.size(), 12U);
  EXPECT_TRUE(same(train(mesh, settings.training, ThreadExecutor(3), never), learned));
  const auto from_cache = [&] {
    return trained(mesh, settings.training, settings.cache, ThreadExecutor(3), never);
  };
  const fs::path file = training_file(settings.cache, mesh, settings.training);
  EXPECT_TRUE(same(from_cache(), learned));
  const std::string whole = bytes_of(file);
  ASSERT_FALSE(whole.empty());
  EXPECT_EQ(std::distance(fs::directory_iterator(settings.cache), {}), 1)
      << "a temporary file is left behind";
  write(file, whole.substr(0, whole.size() / 2));
  EXPECT_TRUE(same(from_cache(), learned));
  EXPECT_EQ(bytes_of(file), whole) << "a damaged file is to be made anew";

  TrainingSettings others = settings.training;
  others.descriptor.largest_bend += 0.01;
  EXPECT_NE(training_file(settings.cache, mesh, others), file);
  EXPECT_TRUE(
      same(trained(mesh, settings.training, "/dev/null/no/folder", SerialExecutor(), never), learned));
}

TEST_F(OurCvfh, ReadsNoDamagedFile) {
  std::vector<CloudDescriptor> descriptors(3);
  Random random(9);
  for (CloudDescriptor& descriptor : descriptors) {
    for (float& bin : descriptor.histogram) bin = static_cast<float>(random.uniform());
    descriptor.of_region = random.below(2) == 0;
    for (Eigen::Index i = 0; i < 12; ++i)
      descriptor.frame_from_cloud.matrix()(i % 3, i / 3) = random.uniform();
  }
  const fs::path file = settings.cache / "descriptors.bin";
  ASSERT_TRUE(write_descriptors(file, 17, descriptors));
  const auto read = read_descriptors(file, 17);
  ASSERT_TRUE(read);
  EXPECT_TRUE(same(*read, descriptors));
  EXPECT_FALSE(read_descriptors(file, 18));
  EXPECT_FALSE(read_descriptors(settings.cache, 17));
  EXPECT_FALSE(read_descriptors(settings.cache / "missing.bin", 17));
  const std::string whole = bytes_of(file);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(testing::Message() << "damage " << i);
    std::string damaged = whole;
    if (i % 2 == 0)
      damaged.resize(random.below(damaged.size()));
    else
      damaged[random.below(damaged.size())] ^= static_cast<char>(1 + random.below(255));
    write(file, damaged);
    EXPECT_FALSE(read_descriptors(file, 17));
  }
}

TEST(OurCvfhSettings, NamesTheFieldAndTheValueThatAreWrong) {
  OurCvfhSettings settings;
  EXPECT_NO_THROW(settings.check());
  settings.training.descriptor.normal_radius = 0.001;
  try {
    settings.check();
    FAIL();
  } catch (const InvalidSetting& error) {
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr("ourcvfh.normal_radius"), testing::HasSubstr("0.001")));
  }
}

TEST(OurCvfhSettings, KeepsWhatIsLearnedWhereCachesBelong) {
  setenv("XDG_CACHE_HOME", "/somewhere", 1);
  EXPECT_EQ(default_training_cache(), "/somewhere/perch");
  setenv("XDG_CACHE_HOME", "relative", 1);
  setenv("HOME", "/home/someone", 1);
  EXPECT_EQ(default_training_cache(), "/home/someone/.cache/perch");
  unsetenv("XDG_CACHE_HOME");
  unsetenv("HOME");
  EXPECT_EQ(default_training_cache(), "");
}

}  // namespace
}  // namespace perch
