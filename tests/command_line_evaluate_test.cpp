#include "command_line_test_support.hpp"
#include "perch/io/result_json.hpp"
#include "perch/localize/localize.hpp"

// What `perch evaluate` finds, writes and refuses.
namespace perch::command_line {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class EvaluateCommand : public CommandLine {
 protected:
  EvaluateCommand() {
    for (const char* name : {"set/a", "set/b"}) write_scene_folder(folder() / name, scene, "");
  }

  /// A result that places every object where it is, and then `change` has its way.
  template <typename Change>
  void write_result(const fs::path& file, const Change& change) const {
    Result result;
    result.status = Status::solved;
    result.guarantee.delta = 0.005;
    result.guarantee.missing_depth = "unexplained";
    for (const TruthPose& truth : scene.scene.truth) {
      ObjectResult& object = result.objects.emplace_back();
      object.model = scene.scene.models[truth.model].name;
      object.pose = truth.pose;
      object.confidence = 0.5;
    }
    Json json = Json::parse(to_json(result));
    change(json);
    write(folder() / file, json.dump());
  }
  void write_result(const fs::path& file) const {
    write_result(file, [](Json&) {});
  }

  std::size_t objects() const { return scene.scene.truth.size(); }
};

TEST_F(EvaluateCommand, FoldersOfScenesAndMethodsSideBySide) {
  write_result("perch/a/result.json");
  write_result("perch/b/result.json");
  write_result("other/a/result.json", [](Json& json) {
    for (Json& object : json["objects"]) object["x"] = object["x"].get<double>() + 0.03;
  });
  const Outcome outcome =
      run({"evaluate", "set", "--results", "perch", "--results", "shifted=other", "-o", "out", "--objects"});
  EXPECT_EQ(outcome.status, 0) << outcome;
  EXPECT_EQ(outcome.err, "");
  for (const char* words : {"shifted: no result for 1 of 2 scenes", "objects within", "30.00"})
    EXPECT_THAT(outcome.out, HasSubstr(words));
  const Json methods = json("out/evaluation.json")["methods"];
  EXPECT_EQ(methods[0]["method"], "perch");
  EXPECT_EQ(methods[0]["right"]["within"], 2 * objects());
  EXPECT_EQ(methods[1]["method"], "shifted");
  EXPECT_EQ(methods[1]["right"]["within"], 0);
  EXPECT_EQ(methods[1]["right"]["ambiguous"], 0);
  EXPECT_EQ(methods[1]["thresholds"][4]["within"], objects());  // 5 cm and 5 degrees
  EXPECT_EQ(methods[1]["not_found"], objects());
  EXPECT_EQ(methods[0]["records"][1]["objects"][0]["visible_fraction"], scene.visible_fractions[0]);
  for (const char* name : {"objects.csv", "thresholds.csv", "thresholds.png", "thresholds.svg",
                           "visibility.png", "visibility.svg"})
    EXPECT_TRUE(fs::is_regular_file(folder() / "out" / name)) << name;
}

// J as `perch score` counts it, at the delta that the result states or the command line gives.
TEST_F(EvaluateCommand, AmbiguityIsByTheCostThatScoreGives) {
  write_result("result.json", [](Json& json) {
    json["objects"][0]["yaw"] = json["objects"][0]["yaw"].get<double>() + 0.5;
    json["objects"][1]["yaw"] = json["objects"][1]["yaw"].get<double>() + 0.5;
    json["guarantee"]["delta"] = 0.003;
  });
  std::vector<Json> truth;
  for (const TruthPose& object : scene.scene.truth)
    truth.push_back({{"model", scene.scene.models[object.model].name},
                     {"x", object.pose.x},
                     {"y", object.pose.y},
                     {"yaw", object.pose.yaw}});
  const auto check = [&](const Arguments& more, const char* delta) {
    Arguments arguments{"evaluate", "scene.yaml", "--results", ".", "-o", "out", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome;
    EXPECT_EQ(outcome.out, "");
    int judged = 0;
    const Json records = json("out/evaluation.json")["methods"][0]["records"][0]["objects"];
    for (std::size_t i = 0; i < objects(); ++i) {
      if (records[i]["costs"].is_null()) continue;  // the can, which any yaw fits
      ++judged;
      Json arrangements{truth, truth};
      arrangements[1][i]["yaw"] = truth[i]["yaw"].get<double>() + 0.5;
      write(folder() / "poses.json", arrangements.dump());
      const Json scores =
          Json::parse(run({"score", "scene.yaml", "--poses", "poses.json", "--delta", delta}).out);
      EXPECT_EQ(records[i]["costs"]["of_truth"], scores[0]["cost"]);
      EXPECT_EQ(records[i]["costs"]["of_estimate"], scores[1]["cost"]);
      const bool ambiguous = scores[1]["cost"] <= scores[0]["cost"];
      EXPECT_EQ(records[i]["verdict"], ambiguous ? "ambiguous" : "missed");
    }
    EXPECT_EQ(judged, 1);
  };
  check({}, "0.003");
  check({"--delta", "0.006"}, "0.006");
}

TEST_F(EvaluateCommand, ResultsLieWhereLocalizePutsThem) {
  const auto found = [&](const Arguments& scenes) {
    Arguments arguments{"evaluate", "--results", "out", "--objects", "-q"};
    arguments.insert(arguments.begin() + 1, scenes.begin(), scenes.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome;
    std::size_t within = 0;
    for (std::size_t at = 0; (at = outcome.out.find("within", at)) != std::string::npos; ++at) ++within;
    return within / objects();
  };
  write_result("out/result.json");  // of an only scene
  EXPECT_EQ(found({"set/a/scene.yaml"}), 1U);
  EXPECT_EQ(found({"set/a"}), 1U);
  EXPECT_EQ(found({"set/a/scene.yaml", "set/b/scene.yaml"}), 0U);
  write_result("out/1_scene/result.json");  // of the second of several files
  EXPECT_EQ(found({"set/a/scene.yaml", "set/b/scene.yaml"}), 1U);
  EXPECT_EQ(found({"set"}), 0U);  // whose order the shell may see otherwise
  write_result("out/b/result.json");
  EXPECT_EQ(found({"set"}), 1U);
  expect_refused({"evaluate", "set/a/scene.yaml", "set/b/scene.yaml", "--results", "out"},
                 {"out/1_scene/result.json", "out/b/result.json", "leave one"});
}

TEST_F(EvaluateCommand, BadInputIsRefused) {
  const auto refused = [&](const Arguments& arguments, const std::vector<std::string>& words) {
    Arguments all{"evaluate"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    expect_refused(all, words);
  };
  const auto refused_result = [&](const auto& change, const std::vector<std::string>& words) {
    write_result("res/a/result.json", change);
    refused({"set", "--results", "res", "-o", "out"}, words);
  };
  write_result("res/b/result.json");
  refused_result([](Json& json) { json["objects"][0]["model"] = "teapot"; },
                 {"res/a/result.json", "objects[0].model", "teapot"});
  refused_result([](Json& json) { json["objects"][0]["x"] = nullptr; }, {"objects[0].x"});
  refused_result([](Json& json) { json["objects"][0]["yaw"] = "NaN"; }, {"objects[0].yaw"});
  refused_result([](Json& json) { json["objects"][0]["x"] = 1e300; }, {"objects[0].x", "1e+300"});
  refused_result([](Json& json) { json.erase("objects"); }, {"objects", "is missing"});
  refused_result([](Json& json) { json["guarantee"]["delta"] = -1; },
                 {"a/result.json: guarantee", "cost.delta"});
  write(folder() / "res/a/result.json", R"({"version": 1, "objects": [{"x": NaN}]})");
  refused({"set", "--results", "res"}, {"res/a/result.json", "is no JSON"});
  fs::remove(folder() / "res/a/result.json");
  fs::create_directory(folder() / "res/a/result.json");
  refused({"set", "--results", "res"}, {"res/a/result.json"});
  fs::remove(folder() / "res/a/result.json");

  refused({"set", "--results", "none"}, {"--results", "none", "no folder"});
  refused({"set", "--results", "scene.yaml"}, {"--results", "no folder"});
  refused({"set", "--results", "=res"}, {"--results", "no name"});
  refused({"set", "--results", "x=res", "--results", "x=set"}, {"--results", "two methods", "x"});
  refused({"set"}, {"--results"});
  refused({"res", "--results", "res"}, {"res", "scene.yaml"});
  refused({"none.yaml", "--results", "res"}, {"none.yaml", "no such file"});
  refused({"set", "set/a/scene.yaml", "--results", "res"}, {"set/a/scene.yaml", "same name"});
  refused({"set", "--results", "res", "-o", "scene.yaml"}, {"scene.yaml"});
  refused({"set", "--results", "res", "--delta", "x"}, {"--delta"});
  write(folder() / "set/b/truth.json", R"({"visible": [1]})");
  refused({"set", "--results", "res"}, {"set/b/truth.json", "visible", "1 entries"});
  fs::remove(folder() / "set/b/truth.json");
  write(folder() / "set/b/scene.yaml", yaml.substr(0, yaml.find("truth:")));
  refused({"set", "--results", "res"}, {"set/b/scene.yaml", "truth: is missing"});
}

// Anything that is a result can be evaluated, however far off.
TEST_F(EvaluateCommand, FarAndAbsentObjectsAreMissed) {
  write_result("out/result.json", [](Json& json) {
    json["objects"][0]["x"] = 1e6;
    json["objects"][0]["yaw"] = 1e300;
    const std::string model = json["objects"][1]["model"];
    json["objects"][1] = {{"model", model}, {"absent", true}};
  });
  const Outcome outcome = run({"evaluate", "scene.yaml", "--results", "out", "-o", "report"});
  EXPECT_EQ(outcome.status, 0) << outcome;
  const Json method = json("report/evaluation.json")["methods"][0];
  EXPECT_EQ(method["right"]["within"], 0);
  EXPECT_EQ(method["not_found"], 1);
  EXPECT_EQ(method["recall"]["ar_vsd"], 0.0);
}

}  // namespace
}  // namespace perch::command_line
