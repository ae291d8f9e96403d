#include <fmt/format.h>

#include "command_line_test_support.hpp"
#include "perch/io/png.hpp"
#include "perch/io/scene_file.hpp"

// `perch inspect`: it finds nothing wrong with good scenes, and each usual mistake in scenes made wrong so.
namespace perch::command_line {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Inspect : public CommandLine {
 protected:
  Outcome inspect(const std::string& text) const {
    write(folder() / "changed.yaml", text);
    return run({"inspect", "changed.yaml"});
  }

  /// The scene made wrong must give one warning, with these words in it.
  void warns(const std::string& text, const std::vector<std::string>& words) const {
    const Outcome outcome = inspect(text);
    EXPECT_EQ(outcome.status, 1) << outcome;
    EXPECT_EQ(outcome.err, "");
    const std::size_t at = outcome.out.find("WARNING: ");
    ASSERT_NE(at, std::string::npos) << outcome;
    for (const std::string& word : words) EXPECT_THAT(outcome.out.substr(at), HasSubstr(word));
    EXPECT_EQ(outcome.out.find("WARNING: ", at + 1), std::string::npos) << outcome;
  }

  std::string with_pose(const Eigen::Matrix4d& m) const {
    std::string text = "  world_from_camera:\n";
    for (int i = 0; i < 4; ++i)
      text += fmt::format("    - [{}, {}, {}, {}]\n", m(i, 0), m(i, 1), m(i, 2), m(i, 3));
    return with_lines(yaml, "world_from_camera:", "observation:", text);
  }

  Eigen::Matrix4d pose() const { return scene.scene.camera.world_from_camera.matrix(); }

  void write_mesh(const Mesh& mesh) const { write(folder() / "models/mug.ply", encode_ply(mesh)); }
  Mesh mug() const {
    for (const SceneModel& model : scene.scene.models)
      if (model.name == "mug") return model.mesh;
    throw std::logic_error("no mug");
  }
};

/// Too slow for sanitizers.
class InspectHeavy : public Inspect {};

TEST_F(Inspect, FindsNothingWrongWithAGoodScene) {
  const Outcome outcome = run({"inspect", "scene.yaml", "-o", "out"});
  EXPECT_EQ(outcome.status, 0) << outcome;
  for (const char* word :
       {"camera ", "depth ", "plane ", "table ", "workspace ", "grid poses", "mug", "nothing looks wrong"})
    EXPECT_THAT(outcome.out, HasSubstr(word));
  EXPECT_THAT(bytes_of(folder() / "out/inspection.png"), ::testing::StartsWith("\x89PNG"));
}

TEST_F(InspectHeavy, CameraPoseOfTheOtherDirectionOrConvention) {
  const Eigen::Matrix4d inverse = pose().inverse();
  warns(with_pose(inverse), {"camera.world_from_camera", "the other way", "give its inverse"});
  const Eigen::Matrix4d graphics = Eigen::Vector4d(1, -1, -1, 1).asDiagonal();
  warns(with_pose(pose() * graphics),
        {"camera.world_from_camera", "as graphics has it", "second and third column"});
  Eigen::Matrix4d optical_from_body;
  optical_from_body << 0, -1, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0, 0, 0, 0, 1;
  warns(with_pose(pose() * optical_from_body), {"camera.world_from_camera", "as robots have it"});
  warns(with_pose(graphics * pose()),
        {"camera.world_from_camera", "z pointing down", "second and third row"});
  Eigen::Matrix4d millimetres = pose();
  millimetres.topRightCorner<3, 1>() *= 1000.0;
  warns(with_pose(millimetres), {"camera.world_from_camera", "millimetres"});
}

TEST_F(InspectHeavy, DepthScaleOffByPowersOfTen) {
  const double scale = scene.scene.depth_scale;
  for (const double factor : {10.0, 0.1, 0.01, 0.001})
    warns(
        with_line(yaml, "depth_scale:", fmt::format("  depth_scale: {}", scale * factor)),
        {"observation.depth_scale", factor > 1 ? "too large; divide it by 10"
                                               : fmt::format("too small; multiply it by {:g}", 1 / factor)});
}

TEST_F(InspectHeavy, TableHeightOff) {
  for (const double off : {0.05, -0.05})
    warns(with_line(yaml, "table:", fmt::format("table: {{height: {}}}", *scene.scene.table_height + off)),
          {"table.height", fmt::format("is {:g} m", *scene.scene.table_height + off), "leave it out"});
}

TEST_F(InspectHeavy, ModelsOfTheWrongSize) {
  Mesh mesh = mug();
  for (Eigen::Vector3f& p : mesh.vertices) p *= 10.0F;
  write_mesh(mesh);
  warns(yaml, {"models.mug", "larger than anything observed", "unit"});
  for (Eigen::Vector3f& p : mesh.vertices) p *= 0.01F;  // a tenth of it
  write_mesh(mesh);
  warns(yaml, {"models.mug", "hardly more than delta", "unit"});
}

TEST_F(Inspect, MillimetresForMetres) {
  Mesh mesh = mug();
  for (Eigen::Vector3f& p : mesh.vertices) p *= 1000.0F;
  write_mesh(mesh);
  expect_refused({"inspect", "scene.yaml", "-o", "out"},
                 {"models.mug.mesh", "millimetres taken for metres? set models.mug.unit: mm"});
}

TEST_F(InspectHeavy, MeshesBesideTheirOriginOrWithHoles) {
  Mesh mesh = mug();
  for (Eigen::Vector3f& p : mesh.vertices) p.x() += 0.2F;
  write_mesh(mesh);
  warns(yaml, {"models.mug.mesh", "origin beside it", "move the mesh over its origin"});
  mesh = mug();
  mesh.triangles.resize(mesh.triangles.size() - 5);
  write_mesh(mesh);
  warns(yaml, {"models.mug.mesh", "not watertight"});
}

TEST_F(InspectHeavy, SymmetryThatIsNotStatedOrIsAboutAnotherAxis) {
  const std::string wrong = replaced(yaml, "symmetry: continuous", "symmetry: none");
  warns(wrong, {"models.can.symmetry", "all sides look the same", "continuous, or auto"});
  Mesh can;
  for (const SceneModel& model : scene.scene.models)
    if (model.name == "can") can = model.mesh;
  for (Eigen::Vector3f& p : can.vertices) p.x() += 0.02F;
  write(folder() / "models/can.ply", encode_ply(can));
  warns(yaml, {"models.can.mesh", "mm off an axis of symmetry (continuous)", "symmetry: auto"});
}

TEST_F(InspectHeavy, DepthThatCantBeHeldAgainstAnything) {
  // Neither workspace nor table height: only what cameras can see at all is known.
  std::string text = with_line(with_line(yaml, "workspace:", ""), "table:", "");
  const double scale = scene.scene.depth_scale;
  warns(with_line(text, "depth_scale:", fmt::format("  depth_scale: {}", scale * 0.01)),
        {"observation.depth_scale", "nearer than", "millimetres are 0.001"});
  const Outcome far =
      inspect(with_line(text, "depth_scale:", fmt::format("  depth_scale: {}", scale * 1000)));
  EXPECT_EQ(far.status, 1) << far;
  EXPECT_THAT(far.out, AllOf(HasSubstr("WARNING: observation.depth_scale puts half of the readings beyond"),
                             HasSubstr("coarser than half of delta")));
}

TEST_F(InspectHeavy, HardlyAnyPoints) {
  const Scene& s = scene.scene;
  Image<std::uint8_t> mask(s.depth.width(), s.depth.height(), 0);
  int left = 60;
  for (std::size_t i = 0; i < mask.size() && left > 0; ++i)
    if (s.depth[i] > 0.0F) {
      mask[i] = 255;
      --left;
    }
  write(folder() / "mask.png", encode_png8_gray(mask));
  EXPECT_THAT(inspect(replaced(yaml, "  depth_scale:", "  mask: mask.png\n  depth_scale:")).out,
              HasSubstr("WARNING: observation leaves 60 points of the objects"));
}

TEST_F(Inspect, InvertedMask) {
  const Scene& s = scene.scene;
  Image<std::uint8_t> mask(s.depth.width(), s.depth.height(), 0);
  DepthImage depth = s.depth;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    mask[i] = depth[i] > 0.0F ? 0 : 255;
    if (!(depth[i] > 0.0F)) depth[i] = 0.9F;
  }
  write(folder() / "depth.png", encode_png16_gray(counts_from_depth(depth, s.depth_scale)));
  write(folder() / "mask.png", encode_png8_gray(mask));
  const Outcome outcome = inspect(replaced(yaml, "  depth_scale:", "  mask: mask.png\n  depth_scale:"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("WARNING: observation.mask"), HasSubstr("is it inverted?")));
}

TEST_F(InspectHeavy, TooManyPoses) {
  const Outcome outcome = run({"inspect", "scene.yaml", "--set", "grid.max_poses=100"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("more than grid.max_poses (100)"), HasSubstr("coarser --resolution")));
  EXPECT_THAT(run({"inspect", "scene.yaml", "--time-limit", "0.0001"}).out,
              HasSubstr("longer than --time-limit"));
}

TEST_F(Inspect, WhatCantBeReadIsRefused) {
  expect_refused({"inspect", "none.yaml", "-o", "out"}, {"none.yaml", "no such file"});
  expect_refused({"inspect"}, {"scene"});
}

}  // namespace
}  // namespace perch::command_line
