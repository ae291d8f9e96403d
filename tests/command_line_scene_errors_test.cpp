#include <fmt/format.h>

#include <cstring>

#include "command_line_test_support.hpp"

// Broken scenes: one line that names file, key and remedy, status 2, nothing written.
namespace perch::command_line {
namespace {

using Words = std::vector<std::string>;

class SceneRefusals : public CommandLine {
 protected:
  /// A scene with this text must be refused by both subcommands.
  void refused(const std::string& text, Words words) const {
    write(folder() / "broken.yaml", text);
    words.push_back("broken.yaml");
    expect_refused(coarse({"localize", "broken.yaml", "-o", "out"}), words);
    write(folder() / "poses.json", "[[]]");
    if (!words.empty()) expect_refused({"score", "broken.yaml", "--poses", "poses.json", "-o", "out"}, words);
  }
  void line_refused(std::string_view first, std::string_view line, const Words& words) const {
    SCOPED_TRACE(line);
    refused(with_line(yaml, first, line), words);
  }
  void change_refused(std::string_view from, std::string_view to, const Words& words) const {
    SCOPED_TRACE(to);
    refused(replaced(yaml, from, to), words);
  }
  void pose_refused(const Eigen::Matrix4d& m, const Words& words) const {
    std::string text = "  world_from_camera:\n";
    for (int i = 0; i < 4; ++i)
      text += fmt::format("    - [{}, {}, {}, {}]\n", m(i, 0), m(i, 1), m(i, 2), m(i, 3));
    SCOPED_TRACE(text);
    refused(with_lines(yaml, "world_from_camera:", "observation:", text), words);
  }
  void mesh_refused(std::string_view bytes, Words words) const {
    const std::string whole = bytes_of(folder() / "models/mug.ply");
    write(folder() / "models/mug.ply", bytes);
    words.insert(words.end(), {"models.mug.mesh", "mug.ply"});
    refused(yaml, words);
    write(folder() / "models/mug.ply", whole);
  }
  void depth_refused(std::string_view bytes, Words words) const {
    const std::string whole = bytes_of(folder() / "depth.png");
    write(folder() / "depth.png", bytes);
    words.push_back("observation.depth");
    refused(yaml, words);
    write(folder() / "depth.png", whole);
  }
};

TEST_F(SceneRefusals, Clutter) {
  change_refused("depth_scale: ", "clutter: maybe\n  depth_scale: ",
                 {"observation.clutter", "maybe", "neither true nor false"});
  expect_refused(coarse({"localize", "scene.yaml", "-o", "out", "--set", "cost.clutter_weight=0"}),
                 {"cost.clutter_weight", "0", "between 1/64 and 1"});
  expect_refused(coarse({"localize", "scene.yaml", "-o", "out", "--set", "cost.clutter_points=none"}),
                 {"cost.clutter_points", "none", "charge, ignore"});
}

TEST_F(SceneRefusals, Files) {
  expect_refused({"localize", "none.yaml", "-o", "out"}, {"none.yaml", "no such file"});
  expect_refused({"localize", "models", "-o", "out"}, {"models", "is a directory"});
  expect_refused({"localize", "depth.png", "-o", "out"}, {"depth.png"});
  expect_refused({"localize", "", "-o", "out"}, {"no such file"});
  refused("", {"is empty"});
  refused("# only a comment\n", {"no YAML document"});
  refused("just words\n", {"a map is expected"});
  refused("[1, 2]\n", {"a map is expected"});
  refused(yaml.substr(0, yaml.find("world_from_camera:")), {"observation", "is missing"});
  refused(yaml.substr(0, yaml.find("fx:")), {"cut short"});
  refused(std::string("\x00\xff\xfe{[\x01", 6), {});
  refused(yaml + "---\n" + yaml, {"2 YAML documents"});
  refused(std::string(100000, '['), {});
}

TEST_F(SceneRefusals, KeysAtEveryLevel) {
  line_refused("version:", "version: 2", {"version", "\"2\"", "give version: 1"});
  line_refused("table:", "tabel: {height: 0}", {"tabel", "unknown key", "did you mean table?"});
  change_refused("fx:", "fxx:", {"camera.intrinsics.fxx", "unknown key", "did you mean fx?"});
  change_refused("world_from_camera:", "camera_from_world:", {"camera.camera_from_world", "unknown key"});
  change_refused("  depth_scale:", "  deep: 1\n  depth_scale:", {"observation.deep", "unknown key"});
  change_refused("{height:", "{tilt: 1, height:", {"table.tilt", "unknown key"});
  change_refused("workspace: {", "workspace: {z: [0, 1], ", {"workspace.z", "unknown key"});
  change_refused("can: {", "can: {colour: red, ", {"models.can.colour", "unknown key"});
  change_refused("- {model:", "- {z: 0, model:", {"truth[0].z", "unknown key"});
  change_refused("version: 1", "version: 1\nversion: 1", {"version", "given twice"});
  for (const std::string key : {"version", "camera", "observation", "models", "objects"}) {
    SCOPED_TRACE(key);
    refused(replaced(yaml, key + ":", "truth_of_" + key + ":"), {"unknown key"});
  }
  line_refused("objects:", "", {"objects", "is missing"});
  line_refused("depth_scale:", "", {"observation.depth_scale", "is missing", "metres per count"});
  refused(with_lines(yaml, "observation:", "table:", ""), {"observation", "is missing"});
}

TEST_F(SceneRefusals, Objects) {
  line_refused("objects:", "objects: [can, mugg]", {"objects[1]", "\"mugg\"", "did you mean mug?"});
  line_refused("objects:", "objects: []", {"objects", "is empty"});
  line_refused("objects:", "objects: can", {"objects", "a list is expected"});
  std::string many = "objects: [can";
  for (int i = 0; i < 1000; ++i) many += ", can";
  line_refused("objects:", many + "]", {"objects", "1001"});
  const auto object = [&](const std::string& entry, const Words& words) {
    line_refused("objects:", "objects: [mug, " + entry + "]", words);
  };
  object("{model: can, optional: 1}",
         {"objects[1].optional", "\"1\"", "true nor false", "give one of these"});
  object("{model: can, optional: yes}", {"objects[1].optional", "\"yes\"", "true nor false"});
  object("{model: can, optional: \"yes\"}", {"objects[1].optional", "\"yes\"", "true nor false"});
  object("{model: can, optional: \"true\"}", {"objects[1].optional", "true nor false"});
  object("{model: can, optional:}", {"objects[1].optional", "true nor false"});
  object("{model: can, absent: true}", {"objects[1].absent", "unknown key", "optional"});
  object("{optional: true}", {"objects[1].model", "is missing", "name a model"});
  object("{model: cup, optional: true}", {"objects[1].model", "\"cup\"", "known: can, mug"});
  object("{model: {can: 1}, optional: true}", {"objects[1].model", "a map"});
  object("[can]", {"objects[1]"});
}

TEST_F(SceneRefusals, Camera) {
  const Eigen::Matrix4d pose = scene.scene.camera.world_from_camera.matrix();
  const auto changed = [&](const auto& change) {
    Eigen::Matrix4d m = pose;
    change(m);
    return m;
  };
  const std::string key = "camera.world_from_camera";
  pose_refused(changed([](auto& m) { m.template topLeftCorner<3, 3>() *= 2.0; }), {key, "not orthonormal"});
  pose_refused(changed([](auto& m) { m.col(0) *= -1.0; }), {key, "reflection"});
  pose_refused(changed([](auto& m) { m(3, 3) = 2.0; }), {key, "last row"});
  pose_refused(changed([](auto& m) { m(0, 3) = std::nan(""); }), {key + "[0][3]"});
  pose_refused(Eigen::Matrix4d::Zero(), {key, "last row"});
  refused(with_lines(yaml, "[0, 0, 0, 1]", "observation:", ""), {key, "has 3 rows"});
  refused(with_lines(yaml, "world_from_camera:", "observation:", ""),
          {key, "is missing", "background: table"});
  for (const auto& [value, word] : std::vector<std::pair<std::string, std::string>>{
           {"0", "fx"}, {"-525", "fx"}, {".nan", "not finite"}, {"wide", "not a number"}, {"[1]", "fx"}}) {
    SCOPED_TRACE(value);
    const std::size_t at = yaml.find("fx: ");
    refused(yaml.substr(0, at) + "fx: " + value + yaml.substr(yaml.find(',', at)), {word, "intrinsics"});
  }
  change_refused("width: 160", "width: 0", {"camera.intrinsics.width"});
  change_refused("width: 160", "width: 1e9", {"camera.intrinsics.width"});
  change_refused("width: 160", "width: 161", {"observation.depth", "depth.png", "160 x 120", "161 x 120"});
  change_refused("height: 120", "height: 60", {"observation.depth", "depth.png", "160 x 60"});
}

TEST_F(SceneRefusals, DepthImage) {
  const std::string depth = bytes_of(folder() / "depth.png");
  depth_refused("", {"depth.png", "is empty"});
  depth_refused("P5 160 120 65535\n", {"depth.png", "not a PNG"});
  depth_refused(depth.substr(0, depth.size() / 2), {"depth.png", "truncated or damaged"});
  depth_refused(depth.substr(0, 20), {"depth.png", "truncated or damaged"});
  depth_refused(depth.substr(0, 4), {"depth.png", "not a PNG"});
  depth_refused(encode_png_color(Image<Rgb>(160, 120, {1, 2, 3})), {"8-bit RGB", "16-bit greyscale"});
  std::string eight_bit = depth;
  eight_bit[24] = 8;  // of the header's bit depth; its checksum no longer fits either
  depth_refused(eight_bit, {"depth.png"});
  depth_refused(encode_png16_gray(Image<std::uint16_t>(160, 119, 700)), {"160 x 119", "160 x 120"});
  depth_refused(encode_png16_gray(Image<std::uint16_t>(160, 120, 0)), {"no observed points", "no pixel"});
  line_refused("depth: ", "  depth: none.png", {"observation.depth", "none.png", "no such file"});
  line_refused("depth: ", "  depth: models", {"observation.depth", "models", "is a directory"});
  line_refused("depth: ", "  depth: models/can.ply", {"observation.depth", "can.ply", "not a PNG"});
  line_refused("depth: ", "  depth: \"\"", {"observation.depth", "is empty"});
}

TEST_F(SceneRefusals, Observation) {
  for (const auto& [value, word] :
       std::vector<std::pair<std::string, std::string>>{{"0", "not > 0"},
                                                        {"-0.001", "not > 0"},
                                                        {".nan", "not finite"},
                                                        {"1e999", "not finite"},
                                                        {"\"0.001\"", "not a number"},
                                                        {"mm", "not a number"}})
    line_refused("depth_scale:", "  depth_scale: " + value, {"observation.depth_scale", word});
  line_refused("depth: ", "  cloud: scene.pcd", {"observation.cloud", "scene.pcd", "no such file"});
  line_refused("background:", "  background: remove", {"observation.background", "did you mean removed?"});
  write(folder() / "mask.png", encode_png16_gray(Image<std::uint16_t>(160, 120, 0)));
  write(folder() / "small.png", encode_png16_gray(Image<std::uint16_t>(80, 60, 1)));
  line_refused("background:", "  mask: mask.png", {"no observed points", "observation.mask"});
  line_refused("background:", "  mask: small.png", {"observation.mask", "80 x 60"});
  line_refused("background:", "  mask: none.png", {"observation.mask", "no such file"});
  line_refused("background:", "  color: models/mug.ply", {"observation.color", "not a PNG"});
}

TEST_F(SceneRefusals, TableAndWorkspace) {
  line_refused("table:", "table: {height: .inf}", {"table.height", "not finite"});
  line_refused("table:", "table: low", {"table", "a map is expected"});
  line_refused("workspace:", "workspace: {x: [0.2, 0.2], y: [0, 1]}", {"workspace.x", "min < max"});
  line_refused("workspace:", "workspace: {x: [0, 1], y: [1, 0]}", {"workspace.y", "min < max"});
  line_refused("workspace:", "workspace: {x: [0, 1], y: [0.1]}", {"workspace.y", "[min, max]"});
  line_refused("workspace:", "workspace: {x: [0, 1]}", {"workspace.y", "is missing"});
  line_refused("workspace:", "workspace: {x: [0, 1], y: [.nan, 1]}", {"workspace.y[0]", "not finite"});
  line_refused("workspace:", "workspace: {x: [-1e300, 1e300], y: [0, 1]}", {"poses", "workspace"});
}

TEST_F(SceneRefusals, Models) {
  const auto model = [&](const std::string& text, const Words& words) { line_refused("mug:", text, words); };
  model("  mug: {mesh: models/mug.ply, unit: cm}", {"models.mug.unit", "\"cm\"", "m or mm"});
  model("  mug: {mesh: models/mug.ply, unit: mm}", {"models.mug.mesh", "metres", "set models.mug.unit: m"});
  model("  mug: {mesh: models/none.ply}", {"models.mug.mesh", "none.ply", "no such file"});
  model("  mug: {mesh: models}", {"models.mug.mesh", "is a directory"});
  model("  mug: {mesh: depth.png}", {"models.mug.mesh", "depth.png", ".ply"});
  model("  mug: {}", {"models.mug.mesh", "is missing"});
  model("  mug: models/mug.ply", {"models.mug", "a map is expected"});
  model("  mug: {mesh: models/mug.ply, base: high}", {"models.mug.base", "not a number"});
  model("  mug: {mesh: models/mug.ply, base: 100}", {"models.mug.base"});
  for (const std::string symmetry : {"0", "361", "-2", "2.5", "round", "\"3\""})
    model("  mug: {mesh: models/mug.ply, symmetry: " + symmetry + "}", {"models.mug.symmetry", "1 to 360"});
  refused(with_lines(yaml, "models:", "objects:", "models: {}\n"), {"models", "at least one"});
}

TEST_F(SceneRefusals, Meshes) {
  const std::string ply = bytes_of(folder() / "models/mug.ply");
  mesh_refused("", {"is empty"});
  mesh_refused("not a mesh", {});
  mesh_refused(ply.substr(0, ply.size() / 2), {"export the mesh again"});
  mesh_refused(ply.substr(0, 40), {"export the mesh again"});
  mesh_refused(
      "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n",
      {"no triangles"});
  std::string with_nan = ply;
  const float nan = std::nanf("");
  std::memcpy(with_nan.data() + ply.find("end_header\n") + 11, &nan, sizeof(nan));
  mesh_refused(with_nan, {"not finite"});
  std::string with_index = ply;
  with_index[ply.size() - 2] = '\x7f';
  mesh_refused(with_index, {"names vertex"});
  Mesh in_millimetres;
  for (const SceneModel& m : scene.scene.models)
    if (m.name == "mug") in_millimetres = m.mesh;
  for (auto& vertex : in_millimetres.vertices) vertex *= 1000.0F;
  mesh_refused(encode_ply(in_millimetres), {"millimetres taken for metres", "set models.mug.unit: mm"});
}

TEST_F(SceneRefusals, Truth) {
  const auto truth = [&](const std::string& entry, const Words& words) {
    SCOPED_TRACE(entry);
    refused(yaml.substr(0, yaml.find("truth:")) + "truth: " + entry + "\n", words);
  };
  truth("[{model: cup, x: 0, y: 0, yaw: 0}]", {"truth[0].model", "\"cup\""});
  truth("[{model: mug, x: 0, y: 0}]", {"truth[0].yaw", "is missing"});
  truth("[{model: mug, x: 0, y: .inf, yaw: 0}]", {"truth[0].y", "not finite"});
  truth("[{model: mug, x: 0, y: 0, yaw: 0, symmetry: 0}]", {"truth[0].symmetry"});
  truth("mug", {"truth", "a list is expected"});
}

TEST_F(SceneRefusals, Priors) {
  const auto priors = [&](const std::string& entry, const Words& words) {
    SCOPED_TRACE(entry);
    refused(yaml + "priors: " + entry + "\n", words);
  };
  priors("[{model: cup, x: 0, y: 0, yaw: 0}]", {"priors[0].model", "\"cup\"", "known: can, mug"});
  priors("[{model: mug, x: 0, y: 0, yaw: 0}, {model: mug, x: 0, y: 0}]", {"priors[1].yaw", "is missing"});
  priors("[{model: mug, x: .nan, y: 0, yaw: 0}]", {"priors[0].x", "not finite"});
  priors("[{model: mug, x: 0, y: 1e999, yaw: 0}]", {"priors[0].y", "not finite"});
  priors("[{model: mug, x: 0, y: 0, yaw: north}]", {"priors[0].yaw", "not a number"});
  priors("[{model: mug, x: 0, y: 0, yaw: 0, symmetry: 2}]", {"priors[0].symmetry", "unknown key"});
  priors("{model: mug, x: 0, y: 0, yaw: 0}", {"priors", "a list is expected"});
  priors("[mug]", {"priors[0]", "a map is expected"});
  priors("mug", {"priors", "a list is expected"});
}

TEST_F(SceneRefusals, PriorFiles) {
  const auto priors_refused = [&](const std::string& file, Words words) {
    words.push_back(file);
    expect_refused(coarse({"localize", "scene.yaml", "--priors", file, "-o", "out"}), words);
  };
  const auto text_refused = [&](std::string_view text, const Words& words) {
    SCOPED_TRACE(text.substr(0, 200));
    write(folder() / "priors.json", text);
    priors_refused("priors.json", words);
  };
  priors_refused("none.json", {"no such file"});
  priors_refused("", {"no such file"});
  priors_refused("models", {"is a directory"});
  priors_refused("depth.png", {});
  text_refused("", {"is empty"});
  text_refused("mug", {"a list is expected", "{model, x, y, yaw}"});
  text_refused(R"({"model": "mug", "x": 0, "y": 0, "yaw": 0})", {"a list is expected"});
  text_refused(R"({"priors": []})", {"a list is expected"});
  text_refused(R"([[{"model": "mug", "x": 0, "y": 0, "yaw": 0}]])", {"[0]", "a map is expected"});
  text_refused(R"([{"model": "cup", "x": 0, "y": 0, "yaw": 0}])", {"[0].model", "\"cup\"", "no model"});
  text_refused(R"([{"model": "mug", "x": NaN, "y": 0, "yaw": 0}])", {"[0].x", "not finite"});
  text_refused(R"([{"model": "mug", "x": .nan, "y": 0, "yaw": 0}])", {"[0].x", "not finite"});
  text_refused(R"([{"model": "mug", "x": 0, "y": 1e999, "yaw": 0}])", {"[0].y", "not finite"});
  text_refused(R"([{"model": "mug", "x": 0, "y": null, "yaw": 0}])", {"[0].y", "not a number"});
  text_refused(R"([{"model": "mug", "x": 0, "y": 0, "yaw": "0"}])", {"[0].yaw", "not a number"});
  text_refused(R"([{"model": "mug", "x": 0, "y": 0}])", {"[0].yaw", "is missing"});
  text_refused(R"([{"model": "mug", "x": 0, "y": 0, "yaw": 0, "score": 0.9}])", {"[0].score", "unknown key"});
  text_refused(R"([{"model": "mug", "x": 0)", {"cut short"});
  text_refused(std::string(100000, '['), {});
  text_refused(std::string("\x00\xff\xfe", 3), {});
}

// The file is checked against every scene before any is worked on: the first one leaves nothing behind.
TEST_F(SceneRefusals, PriorsThatOneSceneOfTwoDoesNotKnow) {
  write(folder() / "other.yaml", replaced(replaced(yaml.substr(0, yaml.find("truth:")), "  mug:", "  cup:"),
                                          "objects: [", "objects: [cup] #"));
  write(folder() / "priors.json", R"([{"model": "mug", "x": 0, "y": 0, "yaw": 0}])");
  expect_refused(coarse({"localize", "scene.yaml", "other.yaml", "--priors", "priors.json", "-o", "out"}),
                 {"priors.json", "[0].model", "mug"});
}

// Of two scenes the second is broken: the first leaves nothing behind either.
TEST_F(SceneRefusals, OneBrokenSceneOfTwo) {
  write(folder() / "broken.yaml", "version: 1\n");
  expect_refused(coarse({"localize", "broken.yaml", "scene.yaml", "-o", "out"}), {"broken.yaml", "camera"});
  expect_refused(coarse({"localize", "scene.yaml", "broken.yaml", "-o", "out"}), {"broken.yaml", "camera"});
}

}  // namespace
}  // namespace perch::command_line
