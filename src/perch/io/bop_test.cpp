#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <numbers>

#include "perch/core/random.hpp"
#include "perch/io/bop_dataset.hpp"
#include "perch/io/bop_results.hpp"
#include "perch/io/png.hpp"
#include "perch/io/test_files.hpp"

// Data sets in BOP layout, written by hand: what is read of them, and what is refused.
namespace perch {
namespace {

using namespace testing_files;
using Eigen::Vector3d;
using nlohmann::json;
using std::numbers::pi;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

/// 9 numbers, row after row.
json rows(const Eigen::Matrix3d& m) {
  json out = json::array();
  for (int i = 0; i < 9; ++i) out.push_back(m(i / 3, i % 3));
  return out;
}

json millimetres(const Vector3d& metres) {
  return {1000.0 * metres.x(), 1000.0 * metres.y(), 1000.0 * metres.z()};
}

/// A camera that looks down at 45 degrees from 0.7 m above the plane.
Eigen::Isometry3d camera_above_plane() {
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  world_from_camera.linear() = Eigen::AngleAxisd(-0.75 * pi, Vector3d::UnitX()).toRotationMatrix();
  world_from_camera.translation() = Vector3d(0.02, -0.7, 0.7);
  return world_from_camera;
}

/// Two models, the box of 100 x 60 x 40 mm of box_corners and itself again, in scene 2 with image 17.
class Bop : public ::testing::Test {
 protected:
  Bop() {
    // In its frame the box spans -50..50, -30..30, -10..30 mm.
    info = {{"3", {{"diameter", 123.288}}},
            {"5",
             {{"diameter", 123.288},
              {"symmetries_discrete", {{-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}},
              {"symmetries_continuous", json::array()}}}};
    const Eigen::Isometry3d camera_from_world = camera_above_plane().inverse();
    camera["17"] = {{"cam_K", {500, 0, 3.5, 0, 510, 2.5, 0, 0, 1}},
                    {"depth_scale", 0.5},
                    {"cam_R_w2c", rows(camera_from_world.linear())},
                    {"cam_t_w2c", millimetres(camera_from_world.translation())}};
    truth["17"] = {annotation(5, Eigen::Isometry3d(Eigen::Translation3d(0.1, 0.0, 0.01))),
                   annotation(3, Eigen::Isometry3d(Eigen::Translation3d(-0.1, 0.05, 0.01))),
                   annotation(5, Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.2, 0.01)))};
    Image<std::uint16_t> depth(8, 6);
    for (std::size_t i = 1; i < depth.size(); ++i) depth[i] = static_cast<std::uint16_t>(1400 + i);
    dir.write("set/test/000002/depth/000017.png", encode_png16_gray(depth));
    for (int i = 0; i < 3; ++i) {
      Image<std::uint8_t> mask(8, 6);
      mask(i, 4) = 255;
      dir.write(fmt::format("set/test/000002/mask_visib/000017_{:06}.png", i), encode_png8_gray(mask));
    }
    for (const char* name : {"obj_000003.ply", "obj_000005.ply"})
      dir.write(std::string("set/models/") + name, ply_binary_box(1.0F));
    targets = {{{"im_id", 17}, {"inst_count", 2}, {"obj_id", 5}, {"scene_id", 2}},
               {{"im_id", 17}, {"inst_count", 1}, {"obj_id", 3}, {"scene_id", 2}}};
    write();
  }

  static json annotation(int obj_id, const Eigen::Isometry3d& world_from_model) {
    const Eigen::Isometry3d camera_from_model = camera_above_plane().inverse() * world_from_model;
    return {{"obj_id", obj_id},
            {"cam_R_m2c", rows(camera_from_model.linear())},
            {"cam_t_m2c", millimetres(camera_from_model.translation())}};
  }

  void write() const {
    dir.write("set/models/models_info.json", info.dump());
    dir.write("set/test/000002/scene_camera.json", camera.dump());
    dir.write("set/test/000002/scene_gt.json", truth.dump());
    dir.write("set/targets.json", targets.dump());
  }
  std::filesystem::path folder() const { return dir.path() / "set"; }
  BopImage read(const BopOptions& options = {}) const {
    BopDataset dataset(folder(), options);
    return dataset.image(dataset.annotated_objects(2, 17));
  }
  /// What is said where the files, as they now are, can't be read.
  std::string refusal(BopOptions options = {}) const {
    options.upright = true;  // faster
    write();
    return input_error([&] { read(options); });
  }

  TemporaryDirectory dir;
  json info, camera, truth, targets;
};

TEST_F(Bop, ReadsAnImage) {
  const BopImage image = read();
  const Scene& scene = image.scene;
  EXPECT_EQ(scene.name, "000002_000017");
  EXPECT_EQ(scene.camera.intrinsics.width, 8);
  EXPECT_EQ(scene.camera.intrinsics.height, 6);
  EXPECT_EQ(scene.camera.intrinsics.fx, 500.0);
  EXPECT_EQ(scene.camera.intrinsics.fy, 510.0);
  EXPECT_EQ(scene.camera.intrinsics.cx, 3.5);
  EXPECT_EQ(scene.camera.intrinsics.cy, 2.5);
  EXPECT_EQ(scene.depth(0, 0), 0.0F);
  EXPECT_EQ(scene.depth(1, 0), static_cast<float>(1401 * 0.0005));
  EXPECT_FALSE(scene.has_camera_pose);
  EXPECT_EQ(scene.background, Background::table);
  EXPECT_FALSE(scene.mask || scene.color || scene.table_height);
  // Model 3 first, in three poses that look different, then model 5, twice.
  ASSERT_EQ(scene.models.size(), 6U);
  EXPECT_EQ(scene.objects, (std::vector<SceneObject>{0, 3, 3}));
  EXPECT_THAT(image.obj_ids, ElementsAre(3, 3, 3, 5, 5, 5));
  EXPECT_EQ(scene.models[0].name, "obj_000003");
  EXPECT_EQ(scene.models[3].name, "obj_000005");
  ASSERT_EQ(image.truth.size(), 3U);
  EXPECT_EQ(image.truth[0].obj_id, 5);
  EXPECT_EQ(image.truth[0].model, 3U);
  EXPECT_LT(
      (camera_above_plane() * image.truth[1].camera_from_model.translation() - Vector3d(-0.1, 0.05, 0.01))
          .norm(),
      1e-9);
}

TEST_F(Bop, BodiesStandAboveTheOriginAndKnowTheWayBack) {
  for (const SceneModel& body : read().scene.models) {
    const Eigen::AlignedBox3f box = body.mesh.bounds();
    EXPECT_NEAR(box.min().z(), 0.0F, 1e-7F);
    EXPECT_NEAR(box.center().head<2>().norm(), 0.0F, 1e-7F);
    // The file's own corners, taken by the body's transform, are the body's.
    for (std::size_t i = 0; i < box_corners.size(); ++i) {
      const Vector3d corner(box_corners[i][0], box_corners[i][1], box_corners[i][2]);
      const Vector3d stood = body.stood_from_model * (0.001 * corner);
      EXPECT_TRUE(
          std::any_of(body.mesh.vertices.begin(), body.mesh.vertices.end(),
                      [&](const Eigen::Vector3f& p) { return (p.cast<double>() - stood).norm() < 1e-7; }));
    }
    EXPECT_NEAR((body.stood_from_model.linear() * body.up).z(), 1.0, 1e-9);
  }
  const auto models = read().scene.models;
  EXPECT_EQ(models[0].symmetry, Symmetry::none()) << "none is declared";
  EXPECT_EQ(models[3].symmetry, Symmetry::n_fold(2));
  EXPECT_EQ(models[4].symmetry, Symmetry::none()) << "lying, the declared axis is not vertical";
}

TEST_F(Bop, AxesOfSymmetryStandAboveTheOrigin) {
  // A turn about the line x = 10, y = -4 mm.
  info["5"] = {{"diameter", 123.288},
               {"symmetries_continuous", {{{"axis", {0, 0, 2}}, {"offset", {10, -4, 99}}}}}};
  write();
  BopOptions options;
  options.upright = true;
  const auto models = read(options).scene.models;
  ASSERT_EQ(models.size(), 2U);
  EXPECT_EQ(models[1].symmetry, Symmetry::continuous());
  EXPECT_LT((models[1].stood_from_model * Vector3d(0.01, -0.004, 0.0)).head<2>().norm(), 1e-9);
  EXPECT_EQ(models[1].stood_from_model.linear(), Eigen::Matrix3d::Identity());
}

TEST_F(Bop, OptionsGiveMaskAndCamera) {
  BopOptions options;
  options.masks = options.camera_pose = true;
  const Scene scene = read(options).scene;
  EXPECT_TRUE(scene.has_camera_pose);
  EXPECT_LT((scene.camera.world_from_camera.matrix() - camera_above_plane().matrix()).norm(), 1e-9);
  ASSERT_TRUE(scene.mask);
  EXPECT_EQ(std::count(scene.mask->data().begin(), scene.mask->data().end(), 0), 48 - 3);
  // Of what is looked for alone.
  BopDataset dataset(folder(), options);
  const Scene alone = dataset.image({2, 17, {{3, 1}}}).scene;
  EXPECT_EQ((*alone.mask)(1, 4), 255);
  EXPECT_EQ(std::count(alone.mask->data().begin(), alone.mask->data().end(), 0), 47);
}

TEST_F(Bop, TargetsByImage) {
  targets.push_back({{"im_id", 3}, {"inst_count", 1}, {"obj_id", 1}, {"scene_id", 2}});
  targets.push_back({{"im_id", 99}, {"inst_count", 4}, {"obj_id", 2}, {"scene_id", 1}});
  write();
  const auto images = read_bop_targets(folder() / "targets.json");
  ASSERT_EQ(images.size(), 3U);
  EXPECT_EQ(images[0].scene_id, 1);
  EXPECT_EQ(images[0].im_id, 99);
  EXPECT_THAT(images[0].objects, ElementsAre(Pair(2, 4)));
  EXPECT_EQ(images[1].im_id, 3);
  EXPECT_EQ(images[2].im_id, 17);
  EXPECT_THAT(images[2].objects, ElementsAre(Pair(3, 1), Pair(5, 2)));
}

TEST_F(Bop, TruthBecomesAPoseOnThePlane) {
  // Bodies at random poses, tilted by a known angle about a horizontal axis through their lowest points'
  // plane.
  Random random(3);
  BopOptions options;
  options.camera_pose = true;
  BopDataset dataset(folder(), options);
  for (int trial = 0; trial < 20; ++trial) {
    SCOPED_TRACE("seed 3, trial " + std::to_string(trial));
    BopImage image = dataset.image(dataset.annotated_objects(2, 17));
    const std::size_t body = random.below(image.scene.models.size());
    const Pose pose{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-pi, pi)};
    const double tilt = random.uniform(0.0, 0.1), lift = random.uniform(-0.01, 0.01),
                 direction = random.uniform(-pi, pi);
    image.scene.table_height = 0.05;
    const Eigen::Isometry3d world_from_stood =
        world_from_model(pose, 0.05 + lift) *
        Eigen::AngleAxisd(tilt, Vector3d(std::cos(direction), std::sin(direction), 0.0));
    BopTruth annotated;
    annotated.obj_id = image.obj_ids[body];
    annotated.model = image.scene.kind(body);
    annotated.camera_from_model =
        camera_above_plane().inverse() * world_from_stood * image.scene.models[body].stood_from_model;
    const auto residuals = set_bop_truth(dataset, {annotated}, image.scene);
    ASSERT_EQ(image.scene.truth.size(), 1U);
    const TruthPose& found = image.scene.truth[0];
    EXPECT_EQ(found.model, body);
    EXPECT_NEAR(found.pose.x, pose.x, 1e-9);
    EXPECT_NEAR(found.pose.y, pose.y, 1e-9);
    // The tilt's axis is horizontal, so that the nearest turn about z is the yaw but for the square of the
    // tilt.
    EXPECT_NEAR(found.symmetry.yaw_difference(found.pose.yaw, pose.yaw), 0.0, tilt * tilt);
    EXPECT_NEAR(residuals[0].tilt, tilt, 1e-6);
    ASSERT_TRUE(residuals[0].lift);
    EXPECT_NEAR(*residuals[0].lift, lift, 1e-9);
  }
}

TEST_F(Bop, ResultsFile) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  pose.translation() = Vector3d(0.5, -0.25, 1.125);
  EXPECT_EQ(
      bop_results_csv({{2, 17, 5, 0.75, pose, 1.5}, {3, 0, 1, 0.0, Eigen::Isometry3d::Identity(), -1.0}}),
      "scene_id,im_id,obj_id,score,R,t,time\n"
      "2,17,5,0.75,0 -1 0 1 0 0 0 0 1,500 -250 1125,1.5\n"
      "3,0,1,0,1 0 0 0 1 0 0 0 1,0 0 0,-1\n");
  EXPECT_EQ(bop_results_name("our_cvfh", "ycbv", "test"), "our-cvfh_ycbv-test.csv");
}

TEST_F(Bop, RefusesBrokenModels) {
  info["3"]["diameter"] = 0.123288;
  EXPECT_THAT(refusal(), AllOf(HasSubstr("models_info.json: 3.diameter: 0.123288 mm"),
                               HasSubstr("obj_000003.ply"), HasSubstr("metres taken for millimetres?")));
  info["3"]["diameter"] = 300;
  EXPECT_THAT(refusal(), AllOf(HasSubstr("3.diameter: 300 mm"), HasSubstr("123.3 mm")));
  info["3"].erase("diameter");
  EXPECT_THAT(refusal(),
              HasSubstr("3.diameter: is missing; give the whole models_info.json of a BOP data set"));
  info.erase("3");
  EXPECT_THAT(refusal(), AllOf(HasSubstr("models_info.json"), HasSubstr("has no model 3")));
  info = json::array({1, 2});
  EXPECT_THAT(refusal(), HasSubstr("a list stands here; a map is expected"));
}

TEST_F(Bop, RefusesBrokenSymmetries) {
  const json kept = info;
  info["5"]["symmetries_discrete"][0][0] = 1;  // a reflection
  EXPECT_THAT(refusal(), HasSubstr("5.symmetries_discrete[0]"));
  info["5"]["symmetries_discrete"][0].erase(3);
  EXPECT_THAT(refusal(), HasSubstr("5.symmetries_discrete[0]: has 15 values; give a list of 16 numbers"));
  info = kept;
  info["5"]["symmetries_continuous"] = {{{"axis", {0, 0, 0}}, {"offset", {0, 0, 0}}}};
  EXPECT_THAT(refusal(), HasSubstr("5.symmetries_continuous[0].axis: has no direction"));
  info["5"]["symmetries_continuous"] = {{{"axis", {0, 0, 1}}}};
  EXPECT_THAT(refusal(), HasSubstr("5.symmetries_continuous[0].offset: is missing"));
}

TEST_F(Bop, RefusesBrokenMeshes) {
  dir.write("set/models/obj_000003.ply", ply_binary_box(0.001F));
  EXPECT_THAT(refusal(), AllOf(HasSubstr("obj_000003.ply"), HasSubstr("metres taken for millimetres?")));
  dir.write("set/models/obj_000003.ply", ply_binary_box(1.0F).substr(0, 300));
  EXPECT_THAT(refusal(), HasSubstr("obj_000003.ply"));
  std::filesystem::remove(folder() / "models/obj_000003.ply");
  EXPECT_THAT(refusal(), HasSubstr("obj_000003.ply: no such file"));
  std::filesystem::remove_all(folder() / "models");
  EXPECT_THAT(input_error([&] { read(); }),
              AllOf(HasSubstr("set/models: no such folder"), HasSubstr("--models")));
}

TEST_F(Bop, RefusesBrokenImages) {
  const json kept = camera;
  camera["17"]["depth_scale"] = 0.0001;
  EXPECT_THAT(refusal(), HasSubstr("17.depth_scale: 0.0001 puts the farthest reading at 0.0001447 m"));
  camera["17"]["depth_scale"] = 1000;
  EXPECT_THAT(refusal(), HasSubstr("at 1447 m; give millimetres per count"));
  camera["17"]["depth_scale"] = 0;
  EXPECT_THAT(refusal(), HasSubstr("17.depth_scale: 0 is not > 0"));
  camera["17"]["depth_scale"] = "1";
  EXPECT_THAT(refusal(), HasSubstr("is not a number"));
  camera = kept;
  camera["17"]["cam_K"][1] = 0.5;
  EXPECT_THAT(refusal(), HasSubstr("17.cam_K: is no camera without skew"));
  camera["17"]["cam_K"] = {0, 0, 3.5, 0, 500, 2.5, 0, 0, 1};
  EXPECT_THAT(refusal(), HasSubstr("17.cam_K: "));
  camera = kept;
  camera["17"].erase("cam_t_w2c");
  BopOptions posed;
  posed.camera_pose = true;
  EXPECT_THAT(refusal(posed), HasSubstr("17: has no cam_R_w2c and cam_t_w2c; leave out --camera-pose"));
  camera = {{"18", kept["17"]}};
  EXPECT_THAT(refusal(), HasSubstr("scene_camera.json: has no image 17; give one of its 1 images"));
  camera = kept;
  write();
  const std::string text = camera.dump();
  dir.write("set/test/000002/scene_camera.json", text.substr(0, text.size() / 2));
  EXPECT_THAT(input_error([&] { read(); }), HasSubstr("scene_camera.json: is no JSON"));
  dir.write("set/test/000002/scene_camera.json", "");
  EXPECT_THAT(input_error([&] { read(); }), HasSubstr("scene_camera.json: is empty"));
  std::filesystem::remove(folder() / "test/000002/scene_camera.json");
  EXPECT_THAT(input_error([&] { read(); }), HasSubstr("scene_camera.json: no such file"));
  write();
  const auto depth = folder() / "test/000002/depth/000017.png";
  dir.write("set/test/000002/depth/000017.png", bytes_of(depth).substr(0, 60));
  EXPECT_THAT(refusal(), AllOf(HasSubstr("000017.png"), HasSubstr("truncated")));
  std::filesystem::remove(depth);
  EXPECT_THAT(refusal(), HasSubstr("depth/000017.png: no such file"));
}

TEST_F(Bop, RefusesBrokenAnnotations) {
  const json kept = truth;
  truth["17"][0]["cam_t_m2c"] = {0.1, 0.0, 0.9};
  EXPECT_THAT(refusal(),
              AllOf(HasSubstr("scene_gt.json: 17[0].cam_t_m2c"), HasSubstr("metres taken for millimetres?")));
  truth["17"][0]["cam_t_m2c"] = {0, 900};
  EXPECT_THAT(refusal(), HasSubstr("17[0].cam_t_m2c: has 2 values; give a list of 3 numbers"));
  truth = kept;
  truth["17"][0]["cam_R_m2c"][0] = 3;
  EXPECT_THAT(refusal(), HasSubstr("17[0].cam_R_m2c"));
  truth["17"][0]["obj_id"] = 1.5;
  EXPECT_THAT(refusal(), HasSubstr("17[0].obj_id: 1.5 is not a whole number"));
  truth["17"][0]["obj_id"] = 77;
  EXPECT_THAT(refusal(), HasSubstr("has no model 77"));
  truth["17"] = json::array();
  EXPECT_THAT(refusal(), AllOf(HasSubstr("annotates nothing in image 17"), HasSubstr("--targets")));
  std::filesystem::remove(folder() / "test/000002/scene_gt.json");
  EXPECT_THAT(input_error([&] { read(); }),
              AllOf(HasSubstr("scene_gt.json: no such file"), HasSubstr("--targets")));
  // With a list of targets nothing is to be annotated.
  BopDataset dataset(folder(), {});
  EXPECT_TRUE(dataset.image(read_bop_targets(folder() / "targets.json").front()).truth.empty());
  BopOptions masked;
  masked.masks = true;
  BopDataset with_masks(folder(), masked);
  EXPECT_THAT(input_error([&] { with_masks.image({2, 17, {{3, 1}}}); }), HasSubstr("leave out --masks"));
}

TEST_F(Bop, RefusesBrokenTargets) {
  const json kept = targets;
  const auto said = [&] {
    write();
    return input_error([&] { read_bop_targets(folder() / "targets.json"); });
  };
  targets[1].erase("inst_count");
  EXPECT_THAT(said(), HasSubstr("targets.json: [1].inst_count: is missing"));
  targets[1]["inst_count"] = 0;
  EXPECT_THAT(said(), HasSubstr("[1].inst_count: 0 is no number of copies"));
  targets = kept;
  targets.push_back(kept[0]);
  EXPECT_THAT(said(), HasSubstr("[2]: names model 5 in image 17 of scene 2 a second time"));
  targets = kept;
  targets[0]["im_id"] = -1;
  EXPECT_THAT(said(), HasSubstr("[0].im_id: -1 is no number of BOP"));
  targets = json::array();
  EXPECT_THAT(said(), HasSubstr("is empty; list at least one target"));
  targets = json::object();
  EXPECT_THAT(said(), HasSubstr("a list is expected"));
}

TEST_F(Bop, RefusesMissingFolders) {
  EXPECT_THAT(input_error([&] { BopDataset(dir.path() / "none", {}); }), HasSubstr("none: no such folder"));
  BopOptions options;
  options.split = "tets";
  EXPECT_THAT(refusal(options),
              AllOf(HasSubstr("set/tets: no such folder"), HasSubstr("did you mean test?")));
  BopDataset dataset(folder(), {});
  EXPECT_THAT(input_error([&] { dataset.annotated_objects(4, 17); }),
              AllOf(HasSubstr("000004: no such folder"), HasSubstr("known: 000002")));
}

}  // namespace
}  // namespace perch
