#include "perch/io/scene_file.hpp"

#include <cstdlib>

#include "perch/core/random.hpp"
#include "perch/io/mesh_file.hpp"
#include "perch/io/test_scene.hpp"

namespace perch {
namespace {

using namespace testing_files;
using ::testing::HasSubstr;

TEST(SceneFile, ReadsEverything) {
  const TemporaryDirectory dir;
  write_scene_files(dir);
  const Scene scene = read_scene(dir.write("breakfast.v2.yaml", scene_text));
  EXPECT_EQ(scene.name, "breakfast.v2");
  EXPECT_EQ(scene.camera.intrinsics.width, 8);
  EXPECT_EQ(scene.camera.intrinsics.height, 6);
  EXPECT_EQ(scene.camera.intrinsics.fx, 525.0);
  EXPECT_EQ(scene.camera.intrinsics.fy, 526.0);
  EXPECT_EQ(scene.camera.intrinsics.cx, 3.5);
  EXPECT_EQ(scene.camera.intrinsics.cy, 2.5);
  EXPECT_NEAR(
      (scene.camera.world_from_camera * Eigen::Vector3d(0, 0, 0.9) - Eigen::Vector3d(0.1, 0.2, 0)).norm(), 0,
      1e-12);
  EXPECT_EQ(scene.depth_scale, 0.001);
  EXPECT_EQ(scene.depth(0, 0), 0.0F);
  EXPECT_EQ(scene.depth(1, 2), static_cast<float>(717 * 0.001));
  ASSERT_TRUE(scene.mask && scene.color && scene.table_height && scene.workspace);
  EXPECT_EQ((*scene.mask)(6, 3), 0);
  EXPECT_EQ((*scene.mask)(7, 3), 1);
  EXPECT_EQ((*scene.color)(7, 5), (Rgb{1, 2, 3}));
  EXPECT_EQ(*scene.table_height, 0.02);
  EXPECT_EQ(scene.workspace->x_min, -0.2);
  EXPECT_EQ(scene.workspace->x_max, 0.2);
  EXPECT_EQ(scene.workspace->y_min, -0.1);
  EXPECT_EQ(scene.workspace->y_max, 0.1);
  ASSERT_EQ(scene.models.size(), 3U);
  EXPECT_EQ(scene.models[0].name, "mug");
  EXPECT_EQ(scene.models[1].name, "can");
  EXPECT_EQ(scene.models[2].name, "box");
  EXPECT_EQ(scene.models[0].base, -0.003);
  EXPECT_EQ(scene.models[1].base, 0.0);
  EXPECT_EQ(scene.models[0].symmetry, Symmetry::none());
  EXPECT_EQ(scene.models[1].symmetry, Symmetry::continuous());
  EXPECT_EQ(scene.models[2].symmetry, Symmetry::n_fold(2));
  for (const SceneModel& model : scene.models) {
    EXPECT_EQ(model.mesh.vertices.size(), 8U);
    EXPECT_EQ(model.mesh.bounds().min().z(), 0.0F) << "stands on the ground";
    EXPECT_NEAR(model.mesh.bounds().max().z(), 0.04F, 1e-7F);
    EXPECT_NEAR(model.mesh.bounds().max().x(), 0.05F, 1e-7F);
  }
  EXPECT_EQ(scene.objects, (std::vector<SceneObject>{0, 0, 1}));
  ASSERT_EQ(scene.truth.size(), 2U);
  EXPECT_EQ(scene.truth[0].model, 0U);
  EXPECT_EQ(scene.truth[0].pose, (Pose{0.1, 0.02, 1.2}));
  EXPECT_EQ(scene.truth[0].symmetry, Symmetry::n_fold(4));
  EXPECT_EQ(scene.truth[1].symmetry, Symmetry::continuous()) << "the model's";
}

TEST(SceneFile, LeavesASymmetryToBeFound) {
  const TemporaryDirectory dir;
  write_scene_files(dir);
  const Scene scene =
      read_scene(dir.write("scene.yaml", replaced(scene_text, "symmetry: continuous", "symmetry: auto")));
  EXPECT_FALSE(scene.models.at(0).find_symmetry);
  EXPECT_TRUE(scene.models.at(1).find_symmetry);
  EXPECT_FALSE(scene.truth.at(0).has_models_symmetry) << "it has its own";
  EXPECT_TRUE(scene.truth.at(1).has_models_symmetry);
}

const std::string json_text = R"({"version": 1, "camera": {
	"intrinsics": {"width":8,"height":6,"fx":5.25e2,"fy":525,"cx":3.5,"cy":2.5},
	"world_from_camera": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]},
  "observation": {"depth":"images/depth.png","depth_scale":0.0001},
  "models": {"b\u00f6x": {"mesh":"meshes\/box.obj"}},
  "objects": ["b\u00f6x"]})";

TEST(SceneFile, ReadsJsonAndLeavesOptionalPartsEmpty) {
  const TemporaryDirectory dir;
  write_scene_files(dir);
  const Scene scene = read_scene(dir.write("scene.json", json_text));
  EXPECT_EQ(scene.models.at(0).name, "b\xc3\xb6x");
  EXPECT_EQ(scene.models[0].symmetry, Symmetry::none());
  EXPECT_FALSE(scene.mask || scene.color || scene.table_height || scene.workspace);
  EXPECT_TRUE(scene.truth.empty());
}

TEST(SceneFile, ReadsOneBodyForEachRestPose) {
  const TemporaryDirectory dir;
  write_scene_files(dir);
  std::string text = replaced(scene_text, "symmetry: continuous",
                              "symmetry: continuous, rest_poses: [[0, 0, 2], [0, 0, -1], [0, -3, 0]]");
  text = replaced(text, "yaw: 1.2", "yaw: 1.2, rest_pose: 0");
  const Scene scene = read_scene(dir.write("scene.yaml", text));
  ASSERT_EQ(scene.models.size(), 5U);
  const std::vector<std::size_t> kinds{0, 1, 1, 1, 4};
  for (std::size_t m = 0; m < 5; ++m) {
    EXPECT_EQ(scene.kind(m), kinds[m]);
    EXPECT_EQ(rest_pose_count(scene.models, m), kinds[m] == 1 ? 3U : 1U);
    EXPECT_EQ(scene.models[m].name, (std::vector<std::string>{"mug", "can", "can", "can", "box"}[m]));
    EXPECT_NEAR(scene.models[m].mesh.bounds().min().z(), 0.0F, 1e-7F);
  }
  EXPECT_EQ(scene.objects, (std::vector<SceneObject>{0, 0, 1})) << "objects are of models";
  EXPECT_EQ(scene.models[1].stood_from_model.matrix(), Eigen::Matrix4d::Identity());
  EXPECT_EQ(scene.models[1].symmetry, Symmetry::continuous());
  EXPECT_EQ(scene.models[2].symmetry, Symmetry::continuous()) << "on its head";
  EXPECT_EQ(scene.models[3].symmetry, Symmetry::none()) << "lying";
  EXPECT_EQ(scene.models[3].up, Eigen::Vector3d(0.0, -1.0, 0.0));
  EXPECT_LT(
      (scene.models[3].stood_from_model.linear() * scene.models[3].up - Eigen::Vector3d::UnitZ()).norm(),
      1e-12);
}

TEST(SceneFile, ReadsAbsolutePathsAndTheCurrentDirectory) {
  const TemporaryDirectory dir, elsewhere;
  write_scene_files(dir);
  const std::string text =
      replaced(json_text, "images/depth.png", (dir.path() / "images/depth.png").string());
  elsewhere.write("meshes/box.obj", obj_box(0.001F));
  EXPECT_NO_THROW(read_scene(elsewhere.write("scene.yaml", text)));

  dir.write("scene.yaml", scene_text);
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(dir.path());
  EXPECT_NO_THROW(read_scene("scene.yaml"));
  std::filesystem::current_path(before);
}

TEST(SceneFile, DamagedFilesLoadOrAreRefusedAndNothingElse) {
  const TemporaryDirectory dir;
  write_scene_files(dir);
  const auto scene_file = dir.write("scene.yaml", scene_text);
  testing::internal::CaptureStderr();
  for (const char* name : {"scene.yaml", "images/depth.png", "images/mask.png", "meshes/box.ply"}) {
    const std::string whole = bytes_of(dir.path() / name);
    for (std::uint64_t seed = 0; seed < 800; ++seed) {
      SCOPED_TRACE(std::string(name) + ", seed " + std::to_string(seed));
      Random random(seed);
      std::string bytes = whole;
      if (seed % 2 == 0) bytes.resize(random.below(bytes.size()));
      for (std::uint64_t k = seed % 2 == 0 ? 0 : 1 + random.below(4); k > 0; --k)
        bytes[random.below(bytes.size())] = static_cast<char>(random.below(256));
      dir.write(name, bytes);
      try {
        const Scene scene = read_scene(scene_file);
        EXPECT_FALSE(scene.objects.empty());
        for (const SceneModel& model : scene.models) EXPECT_EQ(mesh_fault(model.mesh), "");
      } catch (const InputError& e) {
        EXPECT_THAT(e.what(), HasSubstr("scene.yaml: "));
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      } catch (const std::exception& e) {
        ADD_FAILURE() << "not an InputError: " << e.what();
      }
    }
    dir.write(name, whole);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(SceneFile, FindsRestPoses) {
  const TemporaryDirectory dir;
  write_scene_files(dir);
  // A box of 100 x 60 x 40 mm looks the same upside down: it stands on its largest side, on the next, on an
  // end.
  const auto text = replaced(scene_text, "symmetry: continuous", "symmetry: none, rest_poses: auto");
  const Scene scene = read_scene(dir.write("scene.yaml", text));
  ASSERT_EQ(scene.models.size(), 5U);
  EXPECT_EQ(scene.objects, (std::vector<SceneObject>{0, 0, 1}));
  const double heights[] = {0.04, 0.06, 0.1};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(scene.models[1 + i].name, "can");
    EXPECT_NEAR(scene.models[1 + i].mesh.bounds().max().z(), heights[i], 1e-6);
  }
  dir.write("meshes/box.ply",
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
            "0 0 0\n90 0 0\n90 90 0\n0 90 0\n4 0 1 2 3\n");
  EXPECT_THAT(
      input_error([&] { read_scene(dir.path() / "scene.yaml"); }),
      HasSubstr("models.can.rest_poses: \"auto\": the mesh is flat or nearly so; list the directions"));
}

TEST(SceneFile, ReadsTheTestData) {
  const char* data = std::getenv("PERCH_TEST_DATA");
  if (!data) GTEST_SKIP() << "PERCH_TEST_DATA names no folder of test scenes";
  std::size_t real = 0, simulated = 0;
  for (const auto& set : std::filesystem::directory_iterator(data)) {
    if (!set.is_directory()) continue;
    const std::string set_name = set.path().filename().string();
    for (const auto& folder : std::filesystem::directory_iterator(set)) {
      const bool is_real = set_name == "real";
      const auto file = folder.path() / (is_real ? "scene_exact.yaml" : "scene_objects.yaml");
      if ((!is_real && !set_name.starts_with("sim")) || !std::filesystem::exists(file)) continue;
      SCOPED_TRACE(file);
      const Scene scene = read_scene(file);
      EXPECT_EQ(scene.truth.size(), scene.objects.size());
      EXPECT_GE(scene.objects.size(), scene.models.size());
      EXPECT_EQ(scene.mask.has_value(), is_real);
      EXPECT_EQ(scene.depth.width(), 640);
      EXPECT_EQ(scene.depth.height(), 480);
      for (const SceneModel& model : scene.models) {
        EXPECT_GE(model.mesh.triangles.size(), 1990U) << model.name;
        EXPECT_GT(model.mesh.bounds().sizes().maxCoeff(), 0.02F) << model.name;
        EXPECT_LT(model.mesh.bounds().sizes().maxCoeff(), 0.5F) << model.name;
      }
      ++(is_real ? real : simulated);
    }
  }
  EXPECT_EQ(real, 5U);
  EXPECT_EQ(simulated, 13U);
}

}  // namespace
}  // namespace perch
