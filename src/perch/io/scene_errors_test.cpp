#include "perch/io/poses_file.hpp"
#include "perch/io/scene_file.hpp"
#include "perch/io/test_scene.hpp"

namespace perch {
namespace {

using namespace testing_files;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class SceneErrors : public ::testing::Test {
 protected:
  SceneErrors() { write_scene_files(dir); }

  std::string refusal(std::string_view text) {
    const auto path = dir.write("scene.yaml", text);
    const std::string message = input_error([&] { read_scene(path); });
    EXPECT_THAT(message, StartsWith(path.string() + ": "));
    return message;
  }
  /// The scene with one piece of text put for another.
  std::string changed(std::string_view from, std::string_view to) {
    return refusal(replaced(scene_text, from, to));
  }

  TemporaryDirectory dir;
};

TEST_F(SceneErrors, Files) {
  EXPECT_THAT(input_error([&] { read_scene(dir.path() / "none.yaml"); }),
              HasSubstr("none.yaml: no such file"));
  EXPECT_THAT(input_error([&] { read_scene(dir.path()); }), HasSubstr("is a directory"));
  EXPECT_THAT(input_error([&] { read_scene(dir.path() / "scene.yaml/below"); }),
              HasSubstr("scene.yaml/below"));
  EXPECT_THAT(input_error([&] { read_scene(""); }), HasSubstr("no such file"));
  EXPECT_THAT(refusal(""), HasSubstr("is empty"));
  EXPECT_THAT(refusal("\n\n"), HasSubstr("no YAML document"));
  EXPECT_THAT(refusal("# nothing\n"), HasSubstr("scene.yaml"));
  EXPECT_THAT(refusal("[1, 2]"), HasSubstr("a list stands where a map is expected"));
  EXPECT_THAT(refusal("hello"), HasSubstr("\"hello\""));
  EXPECT_THAT(refusal("version: 1\ncamera: {intrinsics: {width"), HasSubstr("is not YAML or is cut short"));
  EXPECT_THAT(refusal(scene_text + "---\n" + scene_text), HasSubstr("2 YAML documents"));
  EXPECT_THAT(refusal(std::string((4 << 20) + 1, '#')), HasSubstr("more than the 4194304"));
  EXPECT_THAT(refusal(std::string(100000, '[')), HasSubstr("scene.yaml"));
  EXPECT_THAT(refusal(std::string("a: ") + std::string(100000, '{')), HasSubstr("scene.yaml"));
  std::string dashes;
  for (int i = 0; i < 50000; ++i) dashes += "- ";
  EXPECT_THAT(refusal(dashes), HasSubstr("scene.yaml"));
}

TEST_F(SceneErrors, UnknownAndRepeatedKeys) {
  EXPECT_THAT(changed("fx: 525.0", "fxx: 525.0"),
              AllOf(HasSubstr("camera.intrinsics.fxx: unknown key"), HasSubstr("did you mean fx?"),
                    HasSubstr("known: width, height, fx, fy, cx, cy")));
  EXPECT_THAT(changed("table:", "tabel:"),
              AllOf(HasSubstr("tabel: unknown key"), HasSubstr("did you mean table?")));
  EXPECT_THAT(changed("symmetry: none,", "symmetries: none,"),
              HasSubstr("models.mug.symmetries: unknown key"));
  EXPECT_THAT(changed("height: 0.02", "height: 0.02, tilt: 1"), HasSubstr("table.tilt: unknown key"));
  EXPECT_THAT(changed("x: [-0.2", "z: [0, 1], x: [-0.2"), HasSubstr("workspace.z: unknown key"));
  EXPECT_THAT(changed("yaw: 1.2", "yaw: 1.2, z: 1"), HasSubstr("truth[0].z: unknown key"));
  EXPECT_THAT(changed("  depth_scale", "  deep: 1\n  depth_scale"),
              HasSubstr("observation.deep: unknown key"));
  EXPECT_THAT(changed("version: 1", "version: 1\nversion: 1"), HasSubstr("version: the key is given twice"));
  EXPECT_THAT(changed("  can: {", "  mug: {"), HasSubstr("models.mug: the key is given twice"));
  EXPECT_THAT(changed("table:", "? [a]\n: 1\ntable:"), HasSubstr("not plain text"));
  EXPECT_THAT(changed("table:", "\"two\\nlines\": 1\ntable:"), HasSubstr("two\\nlines: unknown key"));
}

TEST_F(SceneErrors, MissingKeys) {
  EXPECT_THAT(changed("version: 1\n", ""), HasSubstr("version: is missing; give version: 1"));
  EXPECT_THAT(changed(", fy: 526", ""), HasSubstr("camera.intrinsics.fy: is missing"));
  EXPECT_THAT(changed("  depth: images/depth.png\n", ""), HasSubstr("observation.depth: is missing"));
  EXPECT_THAT(changed("  depth_scale: 0.001\n", ""), HasSubstr("observation.depth_scale: is missing"));
  EXPECT_THAT(changed("{height: 0.02}", "{}"), HasSubstr("table.height: is missing"));
  EXPECT_THAT(changed(", y: [-0.1, 1e-1]", ""), HasSubstr("workspace.y: is missing"));
  EXPECT_THAT(changed("mesh: meshes/box.obj, ", ""), HasSubstr("models.box.mesh: is missing"));
  EXPECT_THAT(changed("objects: [mug, mug, can]\n", ""), HasSubstr("objects: is missing"));
  EXPECT_THAT(changed("yaw: 1.2, ", ""), HasSubstr("truth[0].yaw: is missing"));
}

TEST_F(SceneErrors, Camera) {
  EXPECT_THAT(changed("fx: 525.0", "fx: \"525\""),
              HasSubstr("camera.intrinsics.fx: \"525\" is not a number"));
  EXPECT_THAT(changed("fx: 525.0", "fx: 5x5"), HasSubstr("is not a number"));
  EXPECT_THAT(changed("fx: 525.0", "fx:"), HasSubstr("camera.intrinsics.fx: nothing is not a number"));
  EXPECT_THAT(changed("fx: 525.0", "fx: [1]"), HasSubstr("a list is not a number"));
  EXPECT_THAT(changed("fx: 525.0", "fx: .nan"), HasSubstr("is not finite"));
  EXPECT_THAT(changed("fx: 525.0", "fx: 1e999"), HasSubstr("is not finite"));
  EXPECT_THAT(changed("fx: 525.0", "fx: -5"), HasSubstr("intrinsics.fx is -5"));
  EXPECT_THAT(changed("width: 8", "width: 0"), HasSubstr("camera.intrinsics.width: \"0\""));
  EXPECT_THAT(changed("width: 8", "width: 8.5"), HasSubstr("whole number"));
  EXPECT_THAT(changed("width: 8", "width: 1000000000000"), HasSubstr("from 1 to 16384"));
  EXPECT_THAT(changed("[0, -1, 0, 0.2]", "[0, 1, 0, 0.2]"),
              AllOf(HasSubstr("camera.world_from_camera: "), HasSubstr("reflection")));
  EXPECT_THAT(changed("[0, 0, 0, 1]]", "[0, 0, 0, 2]]"), HasSubstr("last row"));
  EXPECT_THAT(changed(", [0, 0, 0, 1]]", "]"), HasSubstr("has 3 rows"));
  EXPECT_THAT(changed("[0, -1, 0, 0.2]", "[0, -1, 0]"),
              HasSubstr("camera.world_from_camera[1]: has 3 values"));
  EXPECT_THAT(changed("[0, -1, 0, 0.2]", "[0, -1, 0, b]"), HasSubstr("camera.world_from_camera[1][3]"));
  EXPECT_THAT(
      changed("  world_from_camera: [[1, 0, 0, 0.1], [0, -1, 0, 0.2], [0, 0, -1, 0.9], [0, 0, 0, 1]]\n", ""),
      AllOf(HasSubstr("camera.world_from_camera"), HasSubstr("is missing"), HasSubstr("background: table")));
}

TEST_F(SceneErrors, Observation) {
  EXPECT_THAT(changed("depth_scale: 0.001", "depth_scale: 0"),
              HasSubstr("observation.depth_scale: \"0\" is not > 0"));
  EXPECT_THAT(changed("depth_scale: 0.001", "depth_scale: .inf"), HasSubstr("is not finite"));
  EXPECT_THAT(changed("width: 8", "width: 9"),
              AllOf(HasSubstr("observation.depth: "), HasSubstr("depth.png: is 8 x 6 pixels, not 9 x 6")));
  EXPECT_THAT(changed("images/mask.png", "images/none.png"),
              AllOf(HasSubstr("observation.mask: "), HasSubstr("no such file")));
  EXPECT_THAT(changed("images/color.png", "images"),
              AllOf(HasSubstr("observation.color: "), HasSubstr("directory")));
  EXPECT_THAT(changed("images/color.png", "\"\""), HasSubstr("observation.color: is empty"));
  EXPECT_THAT(changed("images/color.png", "\"a\\0b\""), HasSubstr("NUL"));
  EXPECT_THAT(changed("images/depth.png", "images/color.png"), HasSubstr("8-bit RGB colour"));
  EXPECT_THAT(changed("background: removed", "background: remove"), HasSubstr("did you mean removed?"));
  EXPECT_THAT(changed("depth: images/depth.png", "cloud: scene.pcd"),
              AllOf(HasSubstr("observation.cloud: "), HasSubstr("no such file")));
}

TEST_F(SceneErrors, TableAndWorkspace) {
  EXPECT_THAT(changed("height: 0.02", "height: low"), HasSubstr("table.height: \"low\""));
  EXPECT_THAT(changed("{height: 0.02}", "0.02"), HasSubstr("table: \"0.02\" stands where a map is expected"));
  EXPECT_THAT(changed("x: [-0.2, 0.2]", "x: [0.2, 0.2]"),
              AllOf(HasSubstr("workspace.x: "), HasSubstr("min < max")));
  EXPECT_THAT(changed("x: [-0.2, 0.2]", "x: [0.2]"), HasSubstr("workspace.x: has 1 values"));
  EXPECT_THAT(changed("x: [-0.2, 0.2]", "x: [0, .inf]"), HasSubstr("workspace.x[1]: "));
}

TEST_F(SceneErrors, Models) {
  EXPECT_THAT(changed("unit: mm, symmetry: none", "unit: cm, symmetry: none"),
              HasSubstr("models.mug.unit: \"cm\" is no unit; give m or mm"));
  EXPECT_THAT(changed("unit: mm, symmetry: none", "unit: m, symmetry: none"),
              AllOf(HasSubstr("models.mug.mesh: "),
                    HasSubstr("is 100 m across: millimetres taken for metres? set models.mug.unit: mm")));
  EXPECT_THAT(changed("symmetry: 2}", "symmetry: 2, unit: mm}"), HasSubstr("set models.box.unit: m"));
  EXPECT_THAT(changed("symmetry: none", "symmetry: \"auto\""), HasSubstr("models.mug.symmetry: "));
  EXPECT_THAT(changed("symmetry: none", "symmetry: round"), HasSubstr("\"round\" is no symmetry"));
  EXPECT_THAT(changed("symmetry: 2", "symmetry: 0"),
              HasSubstr("models.box.symmetry: \"0\" is not a whole number from 1 to 360"));
  EXPECT_THAT(changed("symmetry: 2", "symmetry: 361"), HasSubstr("from 1 to 360"));
  EXPECT_THAT(changed("symmetry: 2", "symmetry: 2.5"), HasSubstr("whole number"));
  EXPECT_THAT(changed("base: -0.003", "base: -6"), HasSubstr("models.mug.base: -6 m is beyond"));
  EXPECT_THAT(changed("base: -0.003", "base: x"), HasSubstr("models.mug.base: \"x\" is not a number"));
  EXPECT_THAT(changed("meshes/box.obj", "meshes/none.obj"),
              AllOf(HasSubstr("models.box.mesh: "), HasSubstr("no such file")));
  EXPECT_THAT(changed("{mesh: meshes/box.obj, symmetry: 2}", "meshes/box.obj"), HasSubstr("models.box: "));
  dir.write("meshes/broken.obj", "v 0 0 0\n");
  EXPECT_THAT(changed("meshes/box.obj", "meshes/broken.obj"), HasSubstr("models.box.mesh: "))
      << "used or not";
}

TEST_F(SceneErrors, ObjectsAndTruth) {
  EXPECT_THAT(
      changed("[mug, mug, can]", "[mug, mugg]"),
      AllOf(HasSubstr("objects[1]: \"mugg\" is no model of the scene"), HasSubstr("did you mean mug?")));
  EXPECT_THAT(changed("[mug, mug, can]", "[]"), HasSubstr("objects: is empty"));
  EXPECT_THAT(changed("[mug, mug, can]", "mug"),
              HasSubstr("objects: \"mug\" stands where a list is expected"));
  std::string many = "[mug";
  for (int i = 0; i < 1000; ++i) many += ", mug";
  EXPECT_THAT(changed("[mug, mug, can]", many + "]"),
              HasSubstr("objects: has 1001 entries; give at most 1000"));
  const auto object = [&](const std::string& entry) { return changed("[mug, mug, can]", "[" + entry + "]"); };
  for (const std::string word : {"1", "yes", "\"yes\"", "\"true\"", "True", "~", "[true]", "{}"})
    EXPECT_THAT(object("can, {model: mug, optional: " + word + "}"),
                AllOf(HasSubstr("objects[1].optional: "), HasSubstr("neither true nor false")))
        << word;
  EXPECT_THAT(object("{model: mug, option: true}"),
              AllOf(HasSubstr("objects[0].option: unknown key"), HasSubstr("did you mean optional?")));
  EXPECT_THAT(object("{optional: true}"), HasSubstr("objects[0].model: is missing; name a model"));
  EXPECT_THAT(object("{}"), HasSubstr("objects[0].model: is missing"));
  EXPECT_THAT(object("{model: mugg, optional: true}"),
              AllOf(HasSubstr("objects[0].model: \"mugg\" is no model"), HasSubstr("did you mean mug?")));
  EXPECT_THAT(object("{model: [mug], optional: true}"), HasSubstr("objects[0].model: "));
  EXPECT_THAT(object("{model: mug, model: can}"), HasSubstr("objects[0].model: the key is given twice"));
  EXPECT_THAT(object("[mug]"), HasSubstr("objects[0]: "));
  EXPECT_THAT(changed("model: can, x", "model: cane, x"), HasSubstr("truth[1].model: \"cane\" is no model"));
  EXPECT_THAT(changed("yaw: 1.2", "yaw: north"), HasSubstr("truth[0].yaw: \"north\" is not a number"));
  EXPECT_THAT(changed("symmetry: 4", "symmetry: auto"),
              HasSubstr("truth[0].symmetry: \"auto\" is no symmetry"));
  EXPECT_THAT(changed("version: 1", "version: 2"), HasSubstr("version: \"2\""));
  EXPECT_THAT(changed("version: 1", "version: \"1\""), HasSubstr("version: \"1\""));
}

TEST_F(SceneErrors, MeshesOfOnePathAreReadOnce) {
  // Each name is used by two models; were the second read too, it would cost the same time again. What can be
  // seen from outside is that they are equal.
  const Scene scene = read_scene(dir.write("scene.yaml", scene_text));
  EXPECT_EQ(scene.models[0].mesh.vertices, scene.models[1].mesh.vertices);
}

class Poses : public SceneErrors {
 protected:
  Poses() : scene(read_scene(dir.write("scene.yaml", scene_text))) {}
  std::string refused(std::string_view text) {
    const auto path = dir.write("poses.json", text);
    const std::string message = input_error([&] { read_poses(path, scene); });
    EXPECT_THAT(message, StartsWith(path.string() + ": "));
    return message;
  }
  Scene scene;
};

TEST_F(Poses, AreReadInOrder) {
  const auto path = dir.write("poses.json", R"([
	[{"model": "can", "x": 0.1, "y": -2e-1, "yaw": 3}, {"model": "mug", "x": 0, "y": 0, "yaw": 0}],
	[],
	[{"yaw": 0.30000000000000004, "y": 1, "x": 2, "model": "box"}]])");
  const auto poses = read_poses(path, scene);
  ASSERT_EQ(poses.size(), 3U);
  ASSERT_EQ(poses[0].size(), 2U);
  EXPECT_EQ(poses[0][0].model, 1U);
  EXPECT_EQ(poses[0][0].pose, (Pose{0.1, -0.2, 3.0}));
  EXPECT_TRUE(poses[1].empty());
  EXPECT_EQ(poses[2].at(0).model, 2U);
  EXPECT_EQ(poses[2][0].pose, (Pose{2.0, 1.0, 0.1 + 0.2}));
  EXPECT_TRUE(read_poses(dir.write("none.json", "[]"), scene).empty());
}

TEST_F(Poses, ErrorsNameTheIndex) {
  const std::string good = R"({"model":"mug","x":0,"y":0,"yaw":0})";
  EXPECT_THAT(refused(std::string("[[") + good + "," + good + R"(,{"model":"mug","x":0,"y":0,"yaw":"0"}]])"),
              HasSubstr("[0][2].yaw: \"0\" is not a number"));
  EXPECT_THAT(refused(R"([[{"model":"mug","x":0,"y":0}]])"), HasSubstr("[0][0].yaw: is missing"));
  EXPECT_THAT(refused(R"([[{"model":"mug","x":0,"y":0,"yaw":0,"z":1}]])"),
              HasSubstr("[0][0].z: unknown key"));
  EXPECT_THAT(refused(R"([[],[{"model":"cup","x":0,"y":0,"yaw":0}]])"),
              AllOf(HasSubstr("[1][0].model: \"cup\" is no model"), HasSubstr("known: mug, can, box")));
  EXPECT_THAT(refused(R"([[{"model":"mug","x":0,"y":null,"yaw":0}]])"), HasSubstr("[0][0].y: nothing"));
  EXPECT_THAT(refused(R"([[{"model":"mug","x":0,"y":1e999,"yaw":0}]])"), HasSubstr("not finite"));
  EXPECT_THAT(refused(std::string("[") + good + "]"),
              HasSubstr("[0]: a map stands where a list is expected"));
  EXPECT_THAT(refused("{}"), HasSubstr("a map stands where a list is expected"));
  EXPECT_THAT(refused(std::string("[[") + good), HasSubstr("cut short"));
  EXPECT_THAT(input_error([&] { read_poses(dir.path() / "no.json", scene); }),
              HasSubstr("no.json: no such file"));
}

}  // namespace
}  // namespace perch
