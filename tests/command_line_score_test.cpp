#include "command_line_test_support.hpp"

// `perch score` and what it takes for poses.
namespace perch::command_line {
namespace {

using ::testing::AnyOf;
using ::testing::Eq;
using ::testing::HasSubstr;

class Score : public CommandLine {
 protected:
  Json truth() const {
    Json poses = Json::array();
    for (const TruthPose& t : scene.scene.truth)
      poses.push_back({{"model", scene.scene.models[t.model].name},
                       {"x", t.pose.x},
                       {"y", t.pose.y},
                       {"yaw", t.pose.yaw}});
    return poses;
  }

  Json scores(const Json& poses) const {
    write(folder() / "poses.json", poses.dump());
    const Outcome outcome = run({"score", "scene.yaml", "--poses", "poses.json"});
    EXPECT_EQ(outcome.status, 0) << outcome;
    EXPECT_EQ(outcome.err, "");
    return Json::parse(outcome.out);
  }
};

class ScoreHeavy : public Score {};

TEST_F(Score, RecordsInOrder) {
  Json swapped = truth();
  std::swap(swapped[0], swapped[1]);
  Json together = truth();
  together[1]["x"] = together[0]["x"].get<double>() + 0.05;  // at one place the can would stand in the mug
  together[1]["y"] = together[0]["y"];
  const Json records = scores({truth(), swapped, Json::array(), together});
  ASSERT_EQ(records.size(), 4U);
  for (const Json& record : records) {
    EXPECT_EQ(record.size(), 7U);
    for (const char* key : {"cost", "cost_observed", "cost_rendered", "rendered_points", "observed_points"})
      EXPECT_TRUE(record.at(key).is_number_integer()) << key;
    EXPECT_TRUE(record.at("monotone").is_boolean());
    EXPECT_TRUE(record.at("collides").is_boolean());
    EXPECT_EQ(record["cost"], record["cost_observed"].get<int>() + record["cost_rendered"].get<int>());
  }
  EXPECT_EQ(records[0], records[1]);
  EXPECT_FALSE(records[0]["collides"]);
  EXPECT_LT(records[0]["cost"], records[0]["observed_points"]);
  // The empty scene leaves all unexplained and renders nothing.
  EXPECT_EQ(records[2]["cost"], records[2]["observed_points"]);
  EXPECT_EQ(records[2]["rendered_points"], 0);
  EXPECT_EQ(records[2]["monotone"], true);
  EXPECT_TRUE(records[3]["collides"]);
}

TEST_F(Score, NothingAskedGivesAnEmptyArray) {
  EXPECT_EQ(scores(Json::array()), Json::array());
}

TEST_F(ScoreHeavy, AgreesWithTheResultAboutItsOwnPoses) {
  for (const std::string mode : {"fixed", "context"}) {
    EXPECT_THAT(run(coarse({"localize", "scene.yaml", "--candidates", mode, "-o", "out"})).status,
                AnyOf(Eq(0), Eq(3)));
    const Json result = json("out/result.json");
    Json reported = Json::array();
    for (const Json& object : result.at("objects"))
      reported.push_back(
          {{"model", object["model"]}, {"x", object["x"]}, {"y", object["y"]}, {"yaw", object["yaw"]}});
    const Json records = scores({reported, result.at("search_objects")});
    for (const char* key : {"cost", "cost_observed", "cost_rendered", "observed_points"})
      EXPECT_EQ(records[0].at(key), result.at(key)) << key;
    EXPECT_EQ(records[1].at("cost"), result.at("search_cost"));
    EXPECT_EQ(records[1].at("collides"), false);
    EXPECT_EQ(records[1].at("monotone"), true);
    const Image<std::uint16_t> rendered = read_png16_gray(folder() / "out/rendered_depth.png", 160, 120);
    EXPECT_EQ(records[0].at("rendered_points"),
              std::count_if(rendered.data().begin(), rendered.data().end(), [](auto c) { return c != 0; }));
  }
}

TEST_F(Score, FileIsWhatIsPrinted) {
  write(folder() / "poses.json", Json::array({truth()}).dump());
  const Outcome outcome = run({"score", "scene.yaml", "--poses", "poses.json", "-o", "scores"});
  EXPECT_EQ(outcome.status, 0) << outcome;
  EXPECT_EQ(bytes_of(folder() / "scores/score.json"), outcome.out);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder() / "scores"), fs::directory_iterator()), 1);
}

TEST_F(ScoreHeavy, DeltaAndThreadsCount) {
  write(folder() / "poses.json", Json::array({truth()}).dump());
  const auto cost = [&](const Arguments& more) {
    Arguments arguments{"score", "scene.yaml", "--poses", "poses.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Json::parse(run(arguments).out).at(0).at("cost").get<int>();
  };
  EXPECT_GT(cost({"--delta", "0.0005"}), cost({"--delta", "0.02"}));
  EXPECT_EQ(cost({"--threads", "1"}), cost({"--threads", "4"}));
  EXPECT_EQ(cost({"--delta", "0.01"}), cost({"--delta", "0.002", "--set", "cost.delta=0.01"}));
}

TEST_F(Score, BrokenPosesAreRefused) {
  const std::string good = R"({"model": "can", "x": 0, "y": 0, "yaw": 0})";
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases{
      {"", {"is empty"}},
      {"[[", {"cut short"}},
      {"\x01\x02{{{[", {"poses.json"}},
      {"{}", {"a list is expected"}},
      {"[" + good + "]", {"[0]", "a list is expected"}},
      {"[[1]]", {"[0][0]", "a map is expected"}},
      {"[[[" + good + "]]]", {"[0][0]", "a map is expected"}},
      {R"([[{"model": "cup", "x": 0, "y": 0, "yaw": 0}]])", {"[0][0].model", "\"cup\"", "can"}},
      {R"([[{"model": "can", "x": 0, "y": 0}]])", {"[0][0].yaw", "is missing"}},
      {R"([[{"model": "can", "x": 0, "y": 0, "yaw": "0"}]])", {"[0][0].yaw", "is not a number"}},
      {R"([[{"model": "can", "x": null, "y": 0, "yaw": 0}]])", {"[0][0].x", "is not a number"}},
      {R"([[{"model": "can", "x": .nan, "y": 0, "yaw": 0}]])", {"[0][0].x", "is not finite"}},
      {R"([[{"model": "can", "x": 0, "y": 0, "yaw": 0, "z": 0}]])", {"[0][0].z", "unknown key"}},
  };
  for (const auto& [text, words] : cases) {
    SCOPED_TRACE(text);
    write(folder() / "poses.json", text);
    std::vector<std::string> all{"poses.json"};
    all.insert(all.end(), words.begin(), words.end());
    expect_refused({"score", "scene.yaml", "--poses", "poses.json", "-o", "out"}, all);
  }
  expect_refused({"score", "scene.yaml", "--poses", "none.json", "-o", "out"}, {"none.json", "no such file"});
  expect_refused({"score", "scene.yaml", "--poses", "models", "-o", "out"}, {"models", "is a directory"});
  expect_refused({"score", "scene.yaml", "-o", "out"}, {"--poses"});
  expect_refused({"score", "--poses", "none.json", "-o", "out"}, {"scene"});
  write(folder() / "poses.json", "[]");
  expect_refused({"score", "none.yaml", "--poses", "poses.json"}, {"none.yaml", "no such file"});
  expect_refused({"score", "scene.yaml", "--poses", "poses.json", "-o", "depth.png"},
                 {"depth.png", "not a directory"});
}

}  // namespace
}  // namespace perch::command_line
