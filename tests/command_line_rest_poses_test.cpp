#include "command_line_result_checks.hpp"
#include "perch/sim/parametric_models.hpp"

// Models that may rest in several ways, from the scene file to what is made of a result.
namespace perch::command_line {
namespace {

using ::testing::HasSubstr;

/// A jug that lies and one that stands, and a can that stands.
SimulatedScene jugs() {
  SceneLayout layout = {"jugs", small_scene(1).scene.camera, {}, {}, {-0.2, 0.2, -0.15, 0.15}};
  for (SceneModel& body :
       bodies_of(household_model("jug"),
                 {Eigen::Vector3d(0.6, 0.0, -0.8), Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY()}))
    layout.models.push_back(std::move(body));
  layout.models.push_back(household_model("can"));
  layout.objects = {{2, {0.1, -0.05, 0.4}}, {1, {-0.1, 0.05, 0.7}}, {3, {0.02, 0.1, 0.0}}};
  return simulate(layout, DepthSensorSettings::clean(), 1);
}

class RestPoses : public CommandLine {
 protected:
  RestPoses() : made(jugs()) {
    write_scene_folder(folder(), made, "");
    yaml = bytes_of(folder() / "scene.yaml");
  }

  Json truth() const {
    Json poses = Json::array();
    for (const TruthPose& t : made.scene.truth)
      poses.push_back({{"model", made.scene.models[t.model].name},
                       {"x", t.pose.x},
                       {"y", t.pose.y},
                       {"yaw", t.pose.yaw},
                       {"rest_pose", made.scene.models[t.model].rest_pose}});
    return poses;
  }

  Json scored(const Json& scenes) const {
    write(folder() / "poses.json", scenes.dump());
    const Outcome outcome = run({"score", "scene.yaml", "--poses", "poses.json"});
    EXPECT_EQ(outcome.status, 0) << outcome;
    return Json::parse(outcome.out);
  }

  const SimulatedScene made;
};

/// Too slow for sanitizers.
class RestPosesHeavy : public RestPoses {};

TEST_F(RestPosesHeavy, AreFoundCheckedAndHeldAgainstTheTruth) {
  const Outcome outcome = run({"localize", "scene.yaml", "-o", "out/jugs"});
  EXPECT_EQ(outcome.status, 0) << outcome;
  EXPECT_THAT(outcome.out, HasSubstr("jug, rest pose 2"));
  const Json result = json("out/jugs/result.json");
  check_certificate(result);
  EXPECT_THAT(result.at("guarantee").at("over").get<std::string>(), HasSubstr("rest pose"));
  std::vector<int> found;
  for (const Json& object : result.at("objects")) {
    if (object.at("model") == "can") {
      EXPECT_FALSE(object.contains("rest_pose")) << "it has one";
      continue;
    }
    found.push_back(object.at("rest_pose"));
    EXPECT_TRUE(object.at("runner_up").contains("rest_pose"));
    // The matrix takes the model's own frame into the world: what points up does.
    const SceneModel& body = made.scene.models[object.at("rest_pose").get<std::size_t>()];
    const Json& matrix = object.at("world_from_model");
    for (std::size_t row = 0; row < 3; ++row) {
      double up = 0.0;
      for (std::size_t i = 0; i < 3; ++i)
        up += matrix[row][i].get<double>() * body.up[static_cast<Eigen::Index>(i)];
      EXPECT_NEAR(up, row == 2 ? 1.0 : 0.0, 1e-9);
    }
  }
  EXPECT_THAT(found, ::testing::UnorderedElementsAre(1, 2));
  EXPECT_THAT(result.at("search_objects").dump(), HasSubstr("rest_pose"));
#ifdef PERCH_HAS_VERIFY
  const Outcome verified = run({"verify", "scene.yaml", "out/jugs/result.json"});
  EXPECT_EQ(verified.status, 0) << verified;
  // Nothing of it can be changed unnoticed.
  Json changed = result;
  for (Json& object : changed["objects"])
    if (object.contains("rest_pose")) object["rest_pose"] = 0;
  write(folder() / "changed.json", changed.dump());
  EXPECT_EQ(run({"verify", "scene.yaml", "changed.json"}).status, 1);
#endif
  const Outcome evaluated = run({"evaluate", "scene.yaml", "--results", "out/jugs", "-o", "evaluation"});
  EXPECT_EQ(evaluated.status, 0) << evaluated;
  EXPECT_THAT(bytes_of(folder() / "evaluation/evaluation.json"),
              ::testing::Not(HasSubstr("other_rest_pose")));
}

TEST_F(RestPoses, AreScored) {
  Json upright = truth();
  upright[0]["rest_pose"] = 1;
  Json as_first = truth();
  as_first[0].erase("rest_pose");
  Json of_first = truth();
  of_first[0]["rest_pose"] = 0;
  const Json records = scored({truth(), upright, as_first, of_first});
  EXPECT_LE(records[0].at("cost"), 2);
  EXPECT_GT(records[1].at("cost"), 100);
  EXPECT_EQ(records[2], records[3]) << "the first where none is named";
  EXPECT_NE(records[2], records[0]);
}

TEST_F(RestPosesHeavy, GuideTheSearchAsPriors) {
  write(folder() / "priors.json", truth().dump());
  const Outcome outcome = run(coarse({"localize", "scene.yaml", "--priors", "priors.json", "-o", "out"}));
  EXPECT_EQ(outcome.status, 0) << outcome;
}

TEST_F(RestPoses, HostileOnesAreRefused) {
  const std::vector<std::pair<std::string, std::string>> refused{
      {"up", "models.jug.rest_poses"},
      {"[]", "is empty"},
      {"[0, 0, 1]", "models.jug.rest_poses[0]"},
      {"[[0, 0]]", "has 2 values"},
      {"[[0, 0, 0]]", "models.jug.rest_poses[0]: has no direction"},
      {"[[0, 0, .nan]]", "models.jug.rest_poses[0][2]"},
      {"[[0, 0, .inf]]", "models.jug.rest_poses[0][2]"},
      {"[[0, 0, high]]", "models.jug.rest_poses[0][2]"},
      {"[[0, 0, 1], [0, 1, 0], [0, 0, 2e300]]", "models.jug.rest_poses[2]: is the direction of entry 0"},
      {"{z: 1}", "models.jug.rest_poses"}};
  const std::size_t begin = yaml.find("rest_poses: ") + 12, end = yaml.find('}', begin);
  for (const auto& [value, word] : refused) {
    SCOPED_TRACE(value);
    write(folder() / "bad.yaml", yaml.substr(0, begin) + value + yaml.substr(end));
    expect_refused({"localize", "bad.yaml"}, {"bad.yaml", word});
  }
  for (const std::string index : {"3", "-1", "1.5", "first", "99999999999"}) {
    SCOPED_TRACE(index);
    write(folder() / "bad.yaml", replaced(yaml, "rest_pose: 2", "rest_pose: " + index));
    expect_refused({"localize", "bad.yaml"}, {"bad.yaml", "truth[0].rest_pose"});
  }
  Json poses = truth();
  poses[2]["rest_pose"] = 1;
  write(folder() / "poses.json", Json::array({poses}).dump());
  expect_refused({"score", "scene.yaml", "--poses", "poses.json"}, {"[0][2].rest_pose"});
  expect_refused({"localize", "scene.yaml", "--method", "bfwor"},
                 {"models.jug.rest_poses", "--method perch"});
}

}  // namespace
}  // namespace perch::command_line
