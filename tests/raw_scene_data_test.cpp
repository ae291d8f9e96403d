// Support planes of raw frames, recorded and simulated, against the camera poses that come with them. The
// folder is found by the environment variable PERCH_TEST_DATA.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <vector>

#include "perch/io/scene_file.hpp"
#include "perch/localize/prepare.hpp"

namespace perch {
namespace {

namespace fs = std::filesystem;

/// How far a plane is from where the given pose has it: the angle of the normals, and the distance below or
/// above the middle of the workspace.
struct PlaneError {
  double degrees = 0.0, metres = 0.0;
};

PlaneError error_of(const SupportPlane& plane, const Scene& given, double true_height) {
  const Eigen::Isometry3d camera_from_world = given.camera.world_from_camera.inverse();
  const Eigen::Vector3d up = camera_from_world.linear() * Eigen::Vector3d::UnitZ();
  const Workspace at = given.workspace.value_or(Workspace{0.0, 0.0, 0.0, 0.0});
  const Eigen::Vector3d middle =
      camera_from_world *
      Eigen::Vector3d(0.5 * (at.x_min + at.x_max), 0.5 * (at.y_min + at.y_max), true_height);
  return {std::atan2(up.cross(plane.normal).norm(), up.dot(plane.normal)) * 180.0 / std::numbers::pi,
          std::abs(plane.above(middle))};
}

/// The world that a plane defines: its normal is z, it is z = 0, and the optical axis meets it in the origin.
void expect_world_of_plane(const Scene& scene) {
  const Eigen::Isometry3d& world_from_camera = scene.camera.world_from_camera;
  const SupportPlane& plane = scene.support->plane;
  EXPECT_NEAR(world_from_camera.linear().determinant(), 1.0, 1e-9);
  EXPECT_LT((world_from_camera.linear() * plane.normal - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_NEAR(world_from_camera.translation().z(), plane.distance, 1e-9);
  EXPECT_NEAR(scene.table_height.value(), 0.0, 1e-9);
  // On the optical axis: below the origin lies nothing but the axis' point.
  const Eigen::Vector3d origin = world_from_camera.inverse() * Eigen::Vector3d::Zero();
  EXPECT_LT(origin.head<2>().norm(), 1e-9);
  // The camera's x along the plane: world y has none of it.
  EXPECT_NEAR((world_from_camera.linear() * Eigen::Vector3d::UnitX()).y(), 0.0, 1e-9);
}

class RawSceneDataHeavy : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("PERCH_TEST_DATA");
    if (data == nullptr) GTEST_SKIP() << "PERCH_TEST_DATA is not set";
    data_ = data;
  }

  /// All files of that name two folders below the data's folders whose names begin so, in order.
  std::vector<fs::path> files(const std::string& prefix, const std::string& name) const {
    std::vector<fs::path> found;
    for (const auto& set : fs::directory_iterator(data_))
      if (set.is_directory() && set.path().filename().string().starts_with(prefix))
        for (const auto& scene : fs::directory_iterator(set))
          if (fs::exists(scene.path() / name)) found.push_back(scene.path() / name);
    std::sort(found.begin(), found.end());
    return found;
  }

  void expect_planes(const std::vector<fs::path>& scenes, double true_height, double most_degrees,
                     double most_metres) const {
    const Settings settings;
    const auto executor = make_executor(0);
    ASSERT_FALSE(scenes.empty());
    fmt::print("{:<34} {:>18} {:>18}\n", "degrees, mm off", "with pose", "without");
    for (const fs::path& file : scenes) {
      SCOPED_TRACE(file);
      const Scene given = read_scene(file);
      Scene bare = given;
      bare.has_camera_pose = false;
      bare.camera.world_from_camera = Eigen::Isometry3d::Identity();
      bare.table_height.reset();
      // These are of another world then.
      bare.workspace.reset();
      bare.truth.clear();
      const Scene with = prepare(given, settings, *executor), without = prepare(bare, settings, *executor);
      ASSERT_TRUE(with.support && without.support);
      EXPECT_EQ(with.camera.world_from_camera.matrix(), given.camera.world_from_camera.matrix());
      EXPECT_FALSE(with.support->camera);
      EXPECT_TRUE(without.support->camera);
      expect_world_of_plane(without);
      const PlaneError a = error_of(with.support->plane, given, true_height),
                       b = error_of(without.support->plane, given, true_height);
      fmt::print("{:<34} {:>9.2f} {:>8.2f} {:>9.2f} {:>8.2f}\n", fs::relative(file, data_).string(),
                 a.degrees, 1e3 * a.metres, b.degrees, 1e3 * b.metres);
      for (const PlaneError& error : {a, b}) {
        EXPECT_LE(error.degrees, most_degrees);
        EXPECT_LE(error.metres, most_metres);
      }
      // What is searched with: the height at the middle of the workspace.
      EXPECT_NEAR(with.table_height.value(), true_height, most_metres + 1e-4);
    }
  }

  fs::path data_;
};

TEST_F(RawSceneDataHeavy, PlanesOfSimulatedFrames) {
  expect_planes(files("sim", "scene_full.yaml"), 0.0, 0.5, 0.002);
}

// The sensor stretches: the table itself is bent by as much.
TEST_F(RawSceneDataHeavy, PlanesOfRecordedFrames) {
  expect_planes(files("real", "scene_raw.yaml"), 0.0, 2.5, 0.015);
}

}  // namespace
}  // namespace perch
