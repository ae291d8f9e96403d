#include "command_line_test_support.hpp"

// What `perch verify` answers, and what it refuses.
namespace perch::command_line {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class VerifyCommand : public CommandLine {
 protected:
  VerifyCommand() {
    const Outcome outcome = run(coarse({"localize", "scene.yaml", "-q", "-o", "out"}));
    EXPECT_EQ(outcome.status, 0) << outcome;
    result = json("out/result.json");
  }

  Outcome verify(const Json& tampered, Arguments more = {}) const {
    write(folder() / "tampered.json", tampered.dump());
    more.insert(more.begin(), {"verify", "scene.yaml", "tampered.json"});
    return run(more);
  }

  Json result;
};

class VerifyCommandHeavy : public VerifyCommand {};

TEST_F(VerifyCommand, TheProgramsResultHolds) {
  const Outcome outcome = run({"verify", "scene.yaml", "out/result.json"});
  EXPECT_EQ(outcome.status, 0) << outcome;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, Not(HasSubstr("WRONG")));
  for (const char* word : {"cost_rendered", "search_cost", "objects[1].visible_fraction", "checks hold"})
    EXPECT_THAT(outcome.out, HasSubstr(word));
}

TEST_F(VerifyCommand, AWrongResultIsCalledSo) {
  result["observed_points"] = result["observed_points"].get<int>() + 1;
  const Outcome outcome = verify(result);
  EXPECT_EQ(outcome.status, 1) << outcome;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, HasSubstr("1 of "));
  const std::size_t line = outcome.out.find("\nobserved_points") + 1;
  EXPECT_THAT(outcome.out.substr(line, outcome.out.find('\n', line) - line), ::testing::EndsWith("  WRONG"));
}

TEST_F(VerifyCommand, QuietSaysItByTheStatus) {
  const Outcome good = verify(result, {"--quiet"});
  EXPECT_EQ(good.status, 0);
  EXPECT_EQ(good.out + good.err, "");
  result["status"] = "time_limit";
  const Outcome bad = verify(result, {"-q"});
  EXPECT_EQ(bad.status, 1);
  EXPECT_EQ(bad.out + bad.err, "");
}

// What the result was counted with is in it; flags go before that.
TEST_F(VerifyCommandHeavy, SettingsComeFromTheResultOrTheFlags) {
  Outcome other = run(coarse({"localize", "scene.yaml", "-q", "-o", "fine", "--delta", "0.002"}));
  EXPECT_THAT(other.err, "");
  EXPECT_EQ(run({"verify", "scene.yaml", "fine/result.json"}).status, 0);
  EXPECT_EQ(run({"verify", "scene.yaml", "fine/result.json", "--delta", "0.004"}).status, 1);
  EXPECT_EQ(run({"verify", "scene.yaml", "fine/result.json", "--set", "cost.delta=0.002"}).status, 0);
  write(folder() / "settings.yaml", "cost: {delta: 0.004}\n");
  EXPECT_EQ(run({"verify", "scene.yaml", "fine/result.json", "--settings", "settings.yaml"}).status, 1);
}

TEST_F(VerifyCommandHeavy, InfeasibleResultsHold) {
  write(folder() / "far.yaml", with_line(yaml, "workspace:", "workspace: {x: [3, 3.1], y: [-4, -3.9]}"));
  EXPECT_EQ(run(coarse({"localize", "far.yaml", "-q", "-o", "far"})).status, 1);
  const Outcome outcome = run({"verify", "far.yaml", "far/result.json"});
  EXPECT_EQ(outcome.status, 0) << outcome;
}

TEST_F(VerifyCommand, BadInputIsRefused) {
  const auto refused = [&](const Json& tampered, const std::vector<std::string>& words) {
    write(folder() / "tampered.json", tampered.dump());
    expect_refused({"verify", "scene.yaml", "tampered.json"}, words);
  };
  Json broken = result;
  broken["objects"][0]["model"] = "teapot";
  refused(broken, {"tampered.json", "objects[0].model", "\"teapot\"", "can"});
  broken = result;
  broken.erase("cost");
  refused(broken, {"tampered.json", "cost", "is missing"});
  broken = result;
  broken["guarantee"]["delta"] = -1;
  refused(broken, {"tampered.json", "guarantee", "cost.delta", "-1"});
  broken = result;
  broken["guarantee"]["missing_depth"] = "maybe";
  refused(broken, {"tampered.json", "guarantee", "'maybe'"});
  write(folder() / "tampered.json", "{");
  expect_refused({"verify", "scene.yaml", "tampered.json"}, {"tampered.json", "is no JSON"});
  expect_refused({"verify", "scene.yaml", "none.json"}, {"none.json", "no such file"});
  expect_refused({"verify", "none.yaml", "out/result.json"}, {"none.yaml", "no such file"});
  expect_refused({"verify", "scene.yaml"}, {"result"});
  expect_refused({"verify", "scene.yaml", "out/result.json", "--delta", "x"}, {"--delta", "'x'"});
}

}  // namespace
}  // namespace perch::command_line
