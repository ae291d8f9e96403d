#include "command_line_result_checks.hpp"

// `perch localize --method`: the baselines write the same files, without a bound.
namespace perch::command_line {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

class Baselines : public CommandLine {
 protected:
  Outcome bfwor(Arguments more = {}) const {
    more.insert(more.begin(), {"localize", "scene.yaml", "--method", "bfwor", "-o", "out"});
    return run(coarse(more));
  }
  void refused(Arguments options, const std::vector<std::string>& words) const {
    SCOPED_TRACE(::testing::PrintToString(options));
    options.insert(options.begin(), {"localize", "scene.yaml", "-o", "out"});
    expect_refused(options, words);
  }
};

class BaselinesHeavy : public Baselines {};

TEST_F(Baselines, WriteTheSameFilesWithoutABound) {
  const Outcome outcome = bfwor();
  EXPECT_EQ(outcome.status, 0) << outcome;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, HasSubstr("scene: unproven"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("bound ")));
  const Json result = json("out/result.json");
  EXPECT_EQ(result.at("method"), "bfwor");
  EXPECT_EQ(result.at("status"), "unproven");
  EXPECT_TRUE(result.at("guarantee").is_null());
  EXPECT_EQ(result.at("counted_with"), (Json{{"delta", 0.005}, {"missing_depth", "unexplained"}}));
  EXPECT_EQ(result.at("lower_bound"), 0);
  EXPECT_TRUE(result.at("search_cost").is_null());
  EXPECT_TRUE(result.at("suboptimality_bound").is_null());
  EXPECT_EQ(result.at("search_objects"), Json::array());
  EXPECT_EQ(result.at("cost"), result.at("cost_observed").get<int>() + result.at("cost_rendered").get<int>());
  EXPECT_GT(result.at("stats").at("rendered"), 0);
  std::vector<std::string> names;
  for (const SceneObject& object : scene.scene.objects)
    names.push_back(scene.scene.models[object.model].name);
  check_objects(result, names, false);
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder() / "out"))
    files.push_back(entry.path().filename().string());
  EXPECT_THAT(files, UnorderedElementsAre("result.json", "trace.jsonl", "rendered_depth.png", "picture.png"));
}

TEST_F(BaselinesHeavy, AreTheSameFromSettingsFiles) {
  ASSERT_EQ(bfwor().status, 0);
  const Json flagged = json("out/result.json");
  write(folder() / "settings.yaml", "method: bfwor\ngrid: {resolution: 0.08, yaw_resolution_deg: 45}\n");
  ASSERT_EQ(run({"localize", "scene.yaml", "--settings", "settings.yaml", "-o", "out", "-q"}).status, 0);
  EXPECT_EQ(json("out/result.json").at("objects"), flagged.at("objects"));
}

TEST_F(Baselines, StopAtTheTimeLimit) {
  const Outcome outcome = run({"localize", "scene.yaml", "--method", "bfwor", "--resolution", "0.003",
                               "--time-limit", "0.2", "-o", "out"});
  EXPECT_EQ(outcome.status, 3) << outcome;
  EXPECT_EQ(json("out/result.json").at("status"), "time_limit");
}

TEST_F(Baselines, RefuseWhatTheyHaveNoUseFor) {
  for (const auto& [option, field] : std::vector<std::pair<Arguments, std::string>>{
           {{"--w", "2"}, "search.w is 2"},
           {{"--anytime"}, "search.anytime is true"},
           {{"--exhaustive"}, "search.exhaustive is true"},
           {{"--search", "focal-mha"}, "search.method is focal-mha"},
           {{"--candidates", "context"}, "search.candidates is context"},
           {{"--max-expansions", "9"}, "search.max_expansions is 9"}}) {
    Arguments arguments{"--method", "bfwor"};
    arguments.insert(arguments.end(), option.begin(), option.end());
    refused(arguments, {field, "bfwor", "--method perch"});
  }
  write(folder() / "priors.json", "[]");
  refused({"--method", "bfwor", "--priors", "priors.json"}, {"--priors", "bfwor", "--method perch"});
  refused({"--method", "sift"}, {"--method", "perch, bfwor, ourcvfh, ppf"});
  refused({"--method", "bfwor", "--set", "bfwor.distance_limit=0"}, {"bfwor.distance_limit", "0"});
  refused({"--method", "bfwor", "--resolution", "0.00001"},
          {"scene.yaml", "poses", "--resolution", "grid.max_poses"});
}

TEST_F(Baselines, SayHowToBuildWhatIsNotBuilt) {
#ifndef PERCH_HAS_PPF
  refused({"--method", "ppf"}, {"ppf is not built in", "libopencv-contrib-dev", "PERCH_OPENCV=ON"});
#endif
#ifndef PERCH_HAS_OUR_CVFH
  refused({"--method", "ourcvfh"}, {"ourcvfh is not built in", "libpcl-dev", "PERCH_PCL=ON"});
#endif
}

#ifdef PERCH_HAS_VERIFY
TEST_F(BaselinesHeavy, AreVerifiedWithoutABound) {
  ASSERT_EQ(bfwor({"--delta", "0.007"}).status, 0);
  const Json result = json("out/result.json");
  const auto verify = [&](const Json& changed) {
    write(folder() / "changed.json", changed.dump());
    return run({"verify", "scene.yaml", "changed.json"});
  };
  const Outcome holds = verify(result);
  EXPECT_EQ(holds.status, 0) << holds;
  EXPECT_THAT(holds.out, HasSubstr("no bound to check"));
  const auto wrong = [&](const std::string& key, const Json& value) {
    SCOPED_TRACE(key);
    Json changed = result;
    changed[key] = value;
    EXPECT_EQ(verify(changed).status, 1);
  };
  wrong("cost", result.at("cost").get<int>() + 100);
  wrong("status", "solved");
  wrong("status", "infeasible");
  wrong("lower_bound", 1);
  wrong("search_cost", result.at("cost"));
  for (const auto& [key, value] : std::vector<std::pair<std::string, Json>>{{"guarantee", Json::object()},
                                                                            {"counted_with", nullptr},
                                                                            {"method", "sift"},
                                                                            {"method", "perch"}}) {
    Json changed = result;
    changed[key] = value;
    write(folder() / "changed.json", changed.dump());
    expect_refused({"verify", "scene.yaml", "changed.json"}, {"changed.json", key == "method" ? "" : key});
  }
}
#endif

}  // namespace
}  // namespace perch::command_line
