#include <fmt/format.h>

#include <regex>

#include "command_line_result_checks.hpp"
#include "perch/io/scene_file.hpp"

// What `perch localize` answers where the input is good.
namespace perch::command_line {
namespace {

using ::testing::AnyOf;
using ::testing::Eq;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

class Localize : public CommandLine {
 protected:
  std::vector<std::string> object_names() const {
    std::vector<std::string> names;
    for (const SceneObject& object : scene.scene.objects)
      names.push_back(scene.scene.models[object.model].name);
    return names;
  }

  /// All of what a run with a scene leaves in its folder.
  void check_output(const fs::path& output, const Outcome& outcome) const {
    const Json result = json(output / "result.json");
    check_keys(result);
    check_objects(result, object_names());
    check_certificate(result);
    EXPECT_EQ(outcome.status, result.at("status") == "solved" ? 0 : 3) << outcome;
    EXPECT_EQ(outcome.err, "");
    const Image<std::uint16_t> rendered = read_png16_gray(folder() / output / "rendered_depth.png", 160, 120);
    std::int64_t visible = 0;
    for (const Json& object : result["objects"]) visible += object["visible_pixels"].get<std::int64_t>();
    EXPECT_EQ(std::count_if(rendered.data().begin(), rendered.data().end(), [](auto c) { return c != 0; }),
              visible);
    EXPECT_TRUE(bytes_of(folder() / output / "picture.png").starts_with("\x89PNG\r\n"));
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder() / output))
      names.push_back(entry.path().filename().string());
    EXPECT_THAT(names,
                UnorderedElementsAre("result.json", "trace.jsonl", "rendered_depth.png", "picture.png"));
  }
};

class LocalizeHeavy : public Localize {};

TEST_F(Localize, WritesAWholeAnswer) {
  const Outcome outcome = run(coarse({"localize", "scene.yaml", "-o", "out"}));
  EXPECT_EQ(outcome.status, 0) << outcome;
  check_output("out", outcome);
  for (const std::string& name : object_names()) EXPECT_THAT(outcome.out, HasSubstr(name));
  EXPECT_THAT(outcome.out, HasSubstr("scene: solved"));
}

TEST_F(LocalizeHeavy, MakesMissingFoldersAndOverwritesItsOwnFiles) {
  EXPECT_EQ(run(coarse({"localize", "scene.yaml", "-o", "a/b/"})).status, 0);
  write(folder() / "a/b/result.json", "old");
  write(folder() / "a/b/note.txt", "kept");
  EXPECT_EQ(run(coarse({"localize", "scene.yaml", "-o", "a/b"})).status, 0);
  check_keys(json("a/b/result.json"));
  EXPECT_EQ(bytes_of(folder() / "a/b/note.txt"), "kept");
}

TEST_F(Localize, WithoutAFolderOnlyPrints) {
  const auto before = contents(folder());
  const Outcome outcome = run(coarse({"localize", "scene.yaml"}));
  EXPECT_EQ(outcome.status, 0) << outcome;
  EXPECT_NE(outcome.out, "");
  EXPECT_EQ(contents(folder()), before);
}

TEST_F(Localize, QuietPrintsNothing) {
  const Outcome outcome = run(coarse({"localize", "--quiet", "scene.yaml", "-o", "out"}));
  EXPECT_EQ(outcome.out, "");
  check_output("out", outcome);
}

TEST_F(LocalizeHeavy, OptimalIsProvenOrNotSaid) {
  check_output("out", run(coarse({"localize", "scene.yaml", "--w", "1", "-o", "out"})));
  EXPECT_EQ(json("out/result.json").at("guarantee").at("w"), 1.0);
  const Outcome stopped =
      run(coarse({"localize", "scene.yaml", "--w", "1", "--max-expansions", "0", "-o", "none"}));
  check_output("none", stopped);
  EXPECT_EQ(json("none/result.json").at("stats").at("expanded"), 0);
}

TEST_F(LocalizeHeavy, EachSceneHasItsFolderAndTheHighestStatusCounts) {
  // The second scene's objects have no place in view.
  write(folder() / "b.yaml", with_line(yaml, "workspace:", "workspace: {x: [3, 3.1], y: [-4, -3.9]}"));
  const Outcome both = run(coarse({"localize", "scene.yaml", "b.yaml", "-o", "out"}));
  EXPECT_EQ(both.status, 1) << both;
  EXPECT_EQ(json("out/0_scene/result.json").at("status"), "solved");
  EXPECT_EQ(json("out/1_b/result.json").at("status"), "infeasible");
  const Outcome other = run(coarse({"localize", "b.yaml", "scene.yaml", "-o", "other"}));
  EXPECT_EQ(other.status, 1) << other;
  check_keys(json("other/1_scene/result.json"));
  EXPECT_TRUE(fs::exists(folder() / "other/0_b/result.json"));
  // Twice the same scene: the numbers keep them apart.
  EXPECT_EQ(run(coarse({"localize", "scene.yaml", "scene.yaml", "-o", "twice"})).status, 0);
  EXPECT_TRUE(fs::exists(folder() / "twice/0_scene/picture.png"));
  EXPECT_TRUE(fs::exists(folder() / "twice/1_scene/picture.png"));
}

TEST_F(Localize, InfeasibleNamesTheObject) {
  write(folder() / "far.yaml", with_line(yaml, "workspace:", "workspace: {x: [3, 3.1], y: [-4, -3.9]}"));
  for (const std::string mode : {"fixed", "context"}) {
    const Outcome outcome = run(coarse({"localize", "far.yaml", "--candidates", mode, "-o", mode}));
    EXPECT_EQ(outcome.status, 1) << outcome;
    EXPECT_EQ(outcome.error_lines(), 1);
    EXPECT_THAT(outcome.err, AnyOf(HasSubstr("can"), HasSubstr("mug")));
    EXPECT_THAT(outcome.err, ::testing::StartsWith("perch: far"));
    const Json result = json(mode + "/result.json");
    check_keys(result);
    EXPECT_EQ(result.at("status"), "infeasible");
    for (const char* key : {"cost", "cost_observed", "cost_rendered", "search_cost", "suboptimality_bound"})
      EXPECT_TRUE(result.at(key).is_null()) << key;
    EXPECT_EQ(result.at("objects"), Json::array());
    EXPECT_EQ(result.at("search_objects"), Json::array());
    EXPECT_FALSE(fs::exists(folder() / mode / "rendered_depth.png"));
  }
}

TEST_F(LocalizeHeavy, AnswersAreEqualAtAnyNumberOfThreads) {
  for (const std::string mode : {"fixed", "context"}) {
    Json first;
    for (const std::string threads : {"1", "2", "4"}) {
      const std::string output = mode + threads;
      const Outcome outcome = run(
          coarse({"localize", "scene.yaml", "--candidates", mode, "--threads", threads, "-q", "-o", output}));
      check_output(output, outcome);
      Json result = json(output + "/result.json");
      EXPECT_EQ(result["stats"]["threads"], std::stoi(threads));
      result["stats"].erase("threads");
      result["stats"].erase("seconds");
      if (first.is_null()) first = result;
      EXPECT_EQ(result, first) << mode << " at " << threads << " threads";
      EXPECT_EQ(bytes_of(folder() / output / "rendered_depth.png"),
                bytes_of(folder() / (mode + "1/rendered_depth.png")));
    }
  }
}

TEST_F(LocalizeHeavy, JsonSceneIsYaml) {
  const Scene& s = scene.scene;
  const Intrinsics& k = s.camera.intrinsics;
  Json text{{"version", 1}};
  text["camera"]["intrinsics"] = {{"width", k.width}, {"height", k.height}, {"fx", k.fx},
                                  {"fy", k.fy},       {"cx", k.cx},         {"cy", k.cy}};
  const Eigen::Matrix4d pose = s.camera.world_from_camera.matrix();
  for (int i = 0; i < 4; ++i)
    text["camera"]["world_from_camera"].push_back({pose(i, 0), pose(i, 1), pose(i, 2), pose(i, 3)});
  text["observation"] = {{"depth", "depth.png"}, {"depth_scale", s.depth_scale}, {"background", "removed"}};
  text["table"]["height"] = *s.table_height;
  text["workspace"] = {{"x", {s.workspace->x_min, s.workspace->x_max}},
                       {"y", {s.workspace->y_min, s.workspace->y_max}}};
  for (const SceneModel& model : s.models)
    text["models"][model.name] = {{"mesh", "models/" + model.name + ".ply"},
                                  {"symmetry", model.symmetry.name()}};
  text["objects"] = object_names();
  write(folder() / "scene.json", text.dump(2));
  EXPECT_EQ(run(coarse({"localize", "scene.json", "-o", "from_json"})).status, 0);
  EXPECT_EQ(run(coarse({"localize", "scene.yaml", "-o", "from_yaml"})).status, 0);
  EXPECT_EQ(json("from_json/result.json").at("objects"), json("from_yaml/result.json").at("objects"));
}

TEST_F(LocalizeHeavy, ACloudGivesTheResultOfItsDepthImage) {
  const Intrinsics& k = scene.scene.camera.intrinsics;
  const DepthImage depth = read_scene(folder() / "scene.yaml").depth;
  std::string cloud = fmt::format(
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {}\nHEIGHT {}\nDATA ascii\n",
      k.width, k.height);
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) {
      const float z = depth(u, v);
      cloud += z == 0.0F ? "nan nan nan\n"
                         : fmt::format("{} {} {}\n", (u - k.cx) / k.fx * double{z},
                                       (v - k.cy) / k.fy * double{z}, z);
    }
  write(folder() / "scene.pcd", cloud);
  std::string text = bytes_of(folder() / "scene.yaml");
  const std::size_t at = text.find("depth: depth.png");
  ASSERT_NE(at, std::string::npos);
  write(folder() / "cloud.yaml", text.replace(at, 16, "cloud: scene.pcd"));
  EXPECT_EQ(run(coarse({"localize", "scene.yaml", "-o", "of_depth"})).status, 0);
  EXPECT_EQ(run(coarse({"localize", "cloud.yaml", "-o", "of_cloud"})).status, 0);
  Json of_depth = json("of_depth/result.json"), of_cloud = json("of_cloud/result.json");
  for (Json* result : {&of_depth, &of_cloud}) (*result)["stats"].erase("seconds");
  EXPECT_EQ(of_cloud, of_depth);
  EXPECT_EQ(bytes_of(folder() / "of_cloud/rendered_depth.png"),
            bytes_of(folder() / "of_depth/rendered_depth.png"));
}

TEST_F(LocalizeHeavy, SymmetriesMayBeLeftToBeFound) {
  const std::string given = bytes_of(folder() / "scene.yaml");
  const std::string asked =
      std::regex_replace(given, std::regex("symmetry: (none|continuous|[0-9]+)"), "symmetry: auto");
  ASSERT_NE(asked, given);
  write(folder() / "auto.yaml", asked);
  EXPECT_EQ(run(coarse({"localize", "scene.yaml", "-o", "given"})).status, 0);
  EXPECT_EQ(run(coarse({"localize", "auto.yaml", "-o", "found"})).status, 0);
  EXPECT_EQ(json("found/result.json").at("objects"), json("given/result.json").at("objects"));
}

TEST_F(Localize, PathsAreRelativeToTheSceneFile) {
  fs::create_directory(folder() / "elsewhere");
  const Outcome outcome =
      run_program(folder() / "elsewhere", coarse({"localize", "../scene.yaml", "-q", "-o", "out"}));
  check_output("elsewhere/out", outcome);
  EXPECT_EQ(run_program(folder() / "elsewhere", {"localize", "scene.yaml"}).status, 2);
}

TEST_F(Localize, AtTheTimeLimitWritesWhatItHas) {
  const auto start = std::chrono::steady_clock::now();
  const Outcome outcome = run({"localize", "scene.yaml", "--resolution", "0.004", "--yaw-resolution-deg", "5",
                               "--time-limit", "0.3", "-o", "out"});
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
  EXPECT_EQ(outcome.status, 3) << outcome;
  EXPECT_EQ(outcome.err, "");
  const Json result = json("out/result.json");
  check_keys(result);
  EXPECT_EQ(result.at("status"), "time_limit");
  if (!result.at("search_cost").is_null()) return check_output("out", outcome);
  for (const char* key : {"cost", "cost_observed", "cost_rendered", "suboptimality_bound"})
    EXPECT_TRUE(result.at(key).is_null()) << key;
  EXPECT_EQ(result.at("objects"), Json::array());
  EXPECT_EQ(result.at("search_objects"), Json::array());
  EXPECT_FALSE(fs::exists(folder() / "out/rendered_depth.png"));
}

// A setting is taken from the file, over it from the flag, over that from --set.
TEST_F(LocalizeHeavy, SettingsFileThenFlagsThenSet) {
  write(folder() / "settings.yaml",
        "search: {w: 2}\ngrid.resolution: 0.09\ngrid: {yaw_resolution_deg: 60}\n");
  const auto guarantee = [&](Arguments more) {
    more.insert(more.begin(), {"localize", "-q", "-o", "out", "--settings", "settings.yaml"});
    more.push_back("scene.yaml");
    const Outcome outcome = run(more);
    EXPECT_THAT(outcome.status, AnyOf(Eq(0), Eq(3))) << outcome;
    return json("out/result.json").at("guarantee");
  };
  const Json file = guarantee({});
  EXPECT_EQ(file.at("w"), 2.0);
  EXPECT_EQ(file.at("resolution_m"), 0.09);
  EXPECT_NEAR(file.at("yaw_resolution_rad"), 1.0471975511965976, 1e-12);
  const Json flag = guarantee({"--w", "2.5"});
  EXPECT_EQ(flag.at("w"), 2.5);
  EXPECT_EQ(flag.at("resolution_m"), 0.09);
  EXPECT_EQ(guarantee({"--set", "search.w=1.5", "--w", "2.5"}).at("w"), 1.5);
  EXPECT_EQ(guarantee({"--set", "search.w=1.5", "--set", "search.w=1.75"}).at("w"), 1.75);
  EXPECT_EQ(guarantee({"--refine", "none", "--set", "grid.resolution=0.1"}).at("refine"), "none");
}

TEST_F(Localize, HelpAndVersionAreNoErrors) {
  for (const Arguments& arguments :
       std::vector<Arguments>{{"--help"}, {"localize", "--help"}, {"score", "--help"}, {"--version"}}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome;
    EXPECT_NE(outcome.out, "");
    EXPECT_EQ(outcome.err, "");
  }
  EXPECT_THAT(run({"localize", "--help"}).out, HasSubstr("cost.delta"));
  EXPECT_THAT(run({"--help"}).out, Not(HasSubstr("branch")));
}

}  // namespace
}  // namespace perch::command_line
