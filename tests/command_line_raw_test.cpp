#include <fmt/format.h>

#include <Eigen/Geometry>

#include "command_line_test_support.hpp"
#include "perch/io/scene_file.hpp"

// Raw frames through the program: the table in view, no mask, no height, with and without a camera pose.
namespace perch::command_line {
namespace {

using ::testing::HasSubstr;

/// A can and a mug on a table, as `perch simulate --table` writes them, with nothing taken out.
class RawFrame : public ::testing::Test {
 protected:
  void SetUp() override {
    const Outcome made = run_program(
        temporary_.path(),
        {"simulate",   "-o",        "set",       "--scenes",  "1",           "--seed",  "3",       "--models",
         "can,mug",    "--objects", "2",         "--repeats", "1",           "--image", "160x120", "--table",
         "--distance", "0.65-0.7",  "--visible", "0.7-1",     "--workspace", "0.3x0.3"});
    ASSERT_EQ(made.status, 0) << made;
    const std::string masked = bytes_of(folder() / "scene.yaml");
    yaml = with_lines(with_line(masked, "table:", ""), "mask:", "models:",
                      "  background: table\nworkspace: {x: [-0.15, 0.15], y: [-0.15, 0.15]}\n");
    truth = read_scene(folder() / "scene.yaml");
    write(folder() / "raw.yaml", yaml);
    // Without the camera pose these are of no known world.
    bare = with_lines(with_line(yaml, "workspace:", ""), "world_from_camera:", "observation:", "");
    bare = bare.substr(0, bare.find("truth:"));
    write(folder() / "bare.yaml", bare);
  }

  fs::path folder() const { return temporary_.path() / "set/000000"; }
  Outcome run(const Arguments& arguments) const { return run_program(folder(), arguments); }
  Json result(const std::string& name) const {
    return Json::parse(bytes_of(folder() / name / "result.json"));
  }

  Eigen::Isometry3d true_camera_from_model(std::size_t i) const {
    return truth.camera.world_from_camera.inverse() * world_from_model(truth.truth[i].pose, 0.0);
  }

  static Eigen::Isometry3d transform(const Json& rows) {
    Eigen::Isometry3d t;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) t(i, j) = rows[i][j].get<double>();
    return t;
  }

  /// Each object stands within a centimetre of where it is, as the camera sees it.
  void expect_found(const Json& found) const {
    ASSERT_EQ(found["objects"].size(), truth.truth.size());
    for (std::size_t i = 0; i < truth.truth.size(); ++i) {
      const Json& object = found["objects"][i];
      EXPECT_EQ(object["model"], truth.models[truth.truth[i].model].name);
      const Eigen::Isometry3d camera_from_model = transform(object["camera_from_model"]),
                              expected = true_camera_from_model(i);
      EXPECT_LT((camera_from_model.translation() - expected.translation()).norm(), 0.01);
      EXPECT_GT(camera_from_model.linear().col(2).dot(expected.linear().col(2)), std::cos(0.01));
      // The world that is reported is the one that maps them.
      EXPECT_TRUE((transform(found["support_plane"]["world_from_camera"]) * camera_from_model)
                      .isApprox(transform(object["world_from_model"]), 1e-9));
    }
  }

  std::string with_pose(const Eigen::Matrix4d& m, const std::string& before_workspace = "") const {
    std::string text = "  world_from_camera:\n";
    for (int i = 0; i < 4; ++i)
      text += fmt::format("    - [{}, {}, {}, {}]\n", m(i, 0), m(i, 1), m(i, 2), m(i, 3));
    return replaced(with_lines(yaml, "world_from_camera:", "observation:", text),
                    "workspace:", before_workspace + "workspace:");
  }

  /// `perch inspect` must give one warning, with these words in it.
  void warns(const std::string& text, const std::vector<std::string>& words) const {
    write(folder() / "changed.yaml", text);
    const Outcome outcome = run({"inspect", "changed.yaml"});
    EXPECT_EQ(outcome.status, 1) << outcome;
    EXPECT_EQ(outcome.err, "");
    const std::size_t at = outcome.out.find("WARNING: ");
    ASSERT_NE(at, std::string::npos) << outcome;
    for (const std::string& word : words) EXPECT_THAT(outcome.out.substr(at), HasSubstr(word));
    EXPECT_EQ(outcome.out.find("WARNING: ", at + 1), std::string::npos) << outcome;
  }

  void refused(const std::string& text, const std::vector<std::string>& words) const {
    write(folder() / "changed.yaml", text);
    const auto before = contents(folder());
    const Outcome outcome = run({"localize", "changed.yaml", "-o", "refused"});
    EXPECT_EQ(outcome.status, 2) << outcome;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.error_lines(), 1) << outcome;
    for (const std::string& word : words) EXPECT_THAT(outcome.err, HasSubstr(word));
    EXPECT_EQ(contents(folder()), before) << "files were left behind or changed";
  }

  Scene truth;  ///< with mask, height and true poses
  std::string yaml, bare;

 private:
  TemporaryFolder temporary_;
};

/// Too slow for sanitizers.
class RawFrameHeavy : public RawFrame {};

TEST_F(RawFrameHeavy, IsSearchedCheckedAndEvaluated) {
  const Outcome found = run({"localize", "raw.yaml", "-o", "out/raw"});
  ASSERT_EQ(found.status, 0) << found;
  const Json raw = result("out/raw"), support = raw["support_plane"];
  expect_found(raw);
  EXPECT_EQ(support["camera_estimated"], false);
  EXPECT_EQ(support["height_estimated"], true);
  EXPECT_NEAR(support["table_height"].get<double>(), 0.0, 0.002);
  EXPECT_TRUE(transform(support["world_from_camera"]).isApprox(truth.camera.world_from_camera, 1e-12));
#ifdef PERCH_HAS_VERIFY
  const Outcome verified = run({"verify", "raw.yaml", "out/raw/result.json"});
  EXPECT_EQ(verified.status, 0) << verified;
  EXPECT_THAT(verified.out, HasSubstr("support_plane.table_height"));
#endif
  // What it says it costs is what the program counts for the same poses.
  Json poses = Json::array({Json::array()});
  for (const Json& object : raw["objects"])
    poses[0].push_back(
        {{"model", object["model"]}, {"x", object["x"]}, {"y", object["y"]}, {"yaw", object["yaw"]}});
  write(folder() / "poses.json", poses.dump());
  const Outcome scored = run({"score", "raw.yaml", "--poses", "poses.json"});
  ASSERT_EQ(scored.status, 0) << scored;
  EXPECT_EQ(Json::parse(scored.out)[0]["cost"], raw["cost"]);

  const Outcome evaluated = run({"evaluate", "raw.yaml", "--results", "out", "-o", "report", "--objects"});
  EXPECT_EQ(evaluated.status, 0) << evaluated;
  EXPECT_TRUE(fs::exists(folder() / "report/evaluation.json"));
}

TEST_F(RawFrameHeavy, WithoutCameraPoseGetsOneFromThePlane) {
  const Outcome found = run({"localize", "bare.yaml", "-o", "out/bare"});
  ASSERT_EQ(found.status, 0) << found;
  const Json result_bare = result("out/bare"), support = result_bare["support_plane"];
  expect_found(result_bare);
  EXPECT_EQ(support["camera_estimated"], true);
  EXPECT_EQ(support["height_estimated"], true);
  EXPECT_EQ(support["table_height"], 0.0);
  const Eigen::Isometry3d world_from_camera = transform(support["world_from_camera"]);
  EXPECT_NEAR(world_from_camera.linear().determinant(), 1.0, 1e-9);
  EXPECT_NEAR(world_from_camera.translation().z(), truth.camera.world_from_camera.translation().z(), 0.002);

  // Its world differs from the true one by a shift and a turn about z: the truth in it.
  std::string text = bare + "truth:\n";
  const Eigen::Isometry3d between = world_from_camera * truth.camera.world_from_camera.inverse();
  for (const TruthPose& t : truth.truth) {
    const Eigen::Isometry3d pose = between * world_from_model(t.pose, 0.0);
    text += fmt::format("  - {{model: {}, x: {}, y: {}, yaw: {}}}\n", truth.models[t.model].name,
                        pose.translation().x(), pose.translation().y(),
                        std::atan2(pose.linear()(1, 0), pose.linear()(0, 0)));
  }
  write(folder() / "bare.yaml", text);
#ifdef PERCH_HAS_VERIFY
  EXPECT_EQ(run({"verify", "bare.yaml", "out/bare/result.json", "--quiet"}).status, 0);
#endif
  const Outcome evaluated = run({"evaluate", "bare.yaml", "--results", "out", "--objects"});
  EXPECT_EQ(evaluated.status, 0) << evaluated;
}

TEST_F(RawFrameHeavy, InspectionNamesTheUsualMistakes) {
  write(folder() / "changed.yaml", yaml);
  EXPECT_EQ(run({"inspect", "changed.yaml"}).status, 0);
  EXPECT_EQ(run({"inspect", "bare.yaml"}).status, 0);
  const Eigen::Matrix4d pose = truth.camera.world_from_camera.matrix();
  const Eigen::Matrix4d half_turn = Eigen::Vector4d(1, -1, -1, 1).asDiagonal();
  // With a height a plane can be made from the pose where none is level: it must not be taken for one seen.
  const std::string height = "table: {height: 0}\n";
  warns(with_pose(pose.inverse()), {"camera.world_from_camera", "the other way", "its inverse"});
  warns(with_pose(pose.inverse(), height), {"camera.world_from_camera", "the other way", "its inverse"});
  warns(with_pose(pose * half_turn), {"camera.world_from_camera", "as graphics has it"});
  warns(with_pose(half_turn * pose, height), {"camera.world_from_camera", "z pointing down"});
  for (const double off : {0.05, -0.05})
    warns(replaced(yaml, "workspace:", fmt::format("table: {{height: {}}}\nworkspace:", off)),
          {"table.height", "the table is seen at"});
  for (const double factor : {10.0, 0.1, 0.001})
    warns(with_line(yaml, "depth_scale:", fmt::format("  depth_scale: {}", truth.depth_scale * factor)),
          {"observation.depth_scale", factor > 1 ? "too large; divide it by" : "too small; multiply it by"});
}

TEST_F(RawFrame, WithoutAPlaneIsRefusedInOneLine) {
  const Eigen::Matrix4d pose = truth.camera.world_from_camera.matrix();
  refused(with_pose(pose.inverse()),
          {"changed.yaml: observation.background: no level plane", "check camera.world_from_camera"});
  // Nothing but a few spots.
  DepthImage depth(160, 120, 0.0F);
  for (int i = 0; i < 300; ++i)
    depth(20 + 37 * i % 120, 10 + 29 * i % 100) = 0.7F + 0.001F * static_cast<float>(71 * i % 500);
  write(folder() / "depth.png", encode_png16_gray(counts_from_depth(depth, truth.depth_scale)));
  refused(bare, {"changed.yaml: observation.background: no support plane is seen", "table.height"});
  write(folder() / "changed.yaml", bare);
  const Outcome inspected = run({"inspect", "changed.yaml"});
  EXPECT_EQ(inspected.status, 1) << inspected;
  EXPECT_THAT(inspected.out, HasSubstr("WARNING: observation.background: no support plane is seen"));
}

}  // namespace
}  // namespace perch::command_line
