#include "command_line_test_support.hpp"

// `perch benchmark`: runs methods over scenes, goes on where it was stopped, compares what they found.
namespace perch::command_line {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Benchmark : public CommandLine {
 protected:
  Benchmark() {
    write_scene_folder(folder() / "set/a", small_scene(1), "");
    write_scene_folder(folder() / "set/b", small_scene(2), "");
  }

  Arguments benchmark(const std::string& methods) const {
    return coarse({"benchmark", "set", "--methods", methods, "-o", "report"});
  }
};

/// Too slow for sanitizers.
class BenchmarkHeavy : public Benchmark {};

TEST_F(BenchmarkHeavy, WritesTheResultsOfAllRunsAndOneComparison) {
  const Outcome outcome = run(benchmark("perch,bfwor"));
  ASSERT_EQ(outcome.status, 0) << outcome;
  EXPECT_EQ(outcome.err, "");
  for (const std::string method : {"perch", "bfwor"}) {
    for (const std::string number : {"a", "b"}) {
      const Json result = json("report/" + method + "/" + number + "/result.json");
      EXPECT_EQ(result.at("method"), method);
      EXPECT_EQ(result.at("objects").size(), 2U);
    }
    EXPECT_THAT(outcome.out, HasSubstr("\n| " + method + " |"));
    EXPECT_THAT(bytes_of(folder() / "report" / ("worst_" + method + ".png")), StartsWith("\x89PNG\r\n"));
  }
  EXPECT_THAT(
      bytes_of(folder() / "report/report.md"),
      AllOf(HasSubstr("2 scenes with 4 objects"), HasSubstr(outcome.out), HasSubstr("(best_bfwor.png)")));
  // What the report says is what `perch evaluate` says of the same results.
  ASSERT_EQ(run({"evaluate", "set", "--results", "perch=report/perch", "--results", "bfwor=report/bfwor",
                 "-o", "evaluation", "-q"})
                .status,
            0);
  EXPECT_EQ(bytes_of(folder() / "report/evaluation.json"), bytes_of(folder() / "evaluation/evaluation.json"));
  EXPECT_EQ(json("report/evaluation.json").at("methods").at(0).at("objects"), 4);
}

TEST_F(BenchmarkHeavy, GoesOnWhereItWasStopped) {
  ASSERT_EQ(run(benchmark("perch")).status, 0);
  const auto of = [&](const std::string& name) { return folder() / "report/perch" / name / "result.json"; };
  // What is there is not made again: seconds differ from run to run.
  const std::string kept = bytes_of(of("a"));
  fs::remove(of("b"));
  ASSERT_EQ(run(benchmark("perch")).status, 0);
  EXPECT_EQ(bytes_of(of("a")), kept);
  EXPECT_TRUE(fs::exists(of("b")));
  // Nor where a method is added.
  ASSERT_EQ(run(benchmark("bfwor,perch")).status, 0);
  EXPECT_EQ(bytes_of(of("a")), kept);
  // A scene that is newer than its result is run anew.
  fs::last_write_time(folder() / "set/a/scene.yaml", fs::last_write_time(of("a")) + std::chrono::seconds(1));
  ASSERT_EQ(run(benchmark("perch")).status, 0);
  EXPECT_NE(bytes_of(of("a")), kept);
}

TEST_F(Benchmark, RefusesWhatWouldCompareUnlikeThings) {
  ASSERT_EQ(run(benchmark("perch")).status, 0);
  Arguments other = benchmark("perch");
  other.insert(other.end(), {"--delta", "0.004"});
  expect_refused(other, {"settings.yaml", "cost.delta: 0.005", "cost.delta: 0.004", "another folder"});
  // The settings it keeps can be read back.
  EXPECT_EQ(run({"benchmark", "set", "--settings", "report/settings.yaml", "-o", "report"}).status, 0);
}

TEST_F(Benchmark, RefusesBadInputBeforeAnythingIsRun) {
  expect_refused(benchmark("perch,magic"), {"--methods", "magic", "bfwor"});
  expect_refused(benchmark("perch,perch"), {"--methods", "perch", "twice"});
  expect_refused({"benchmark", "nowhere", "-o", "report"}, {"nowhere"});
  expect_refused({"benchmark", "set", "-o", "report", "--set", "method=bfwor"}, {"method", "--methods"});
  const std::string whole = bytes_of(folder() / "set/b/scene.yaml");
  write(folder() / "set/b/scene.yaml", whole.substr(0, whole.find("\ntruth:") + 1));
  expect_refused(benchmark("perch"), {"set/b/scene.yaml", "truth"});
  write(folder() / "set/b/scene.yaml", "version: 1\n");
  expect_refused(benchmark("perch"), {"set/b/scene.yaml"});
}

}  // namespace
}  // namespace perch::command_line
