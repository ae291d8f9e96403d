#include "command_line_test_support.hpp"
#ifdef PERCH_MPIEXEC
#include "ranks_test_support.hpp"
#endif

// `perch benchmark`: runs methods over scenes, goes on where it was stopped, compares what they found.
namespace perch::command_line {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
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

#ifdef PERCH_MPIEXEC

/// As it is but for how long it took.
Json without_seconds(const Json& all) {
  if (!all.is_structured()) return all;
  Json kept = all.is_object() ? Json::object() : Json::array();
  for (const auto& [key, value] : all.items()) {
    if (all.is_array())
      kept.push_back(without_seconds(value));
    else if (key.find("seconds") == std::string::npos)
      kept[key] = without_seconds(value);
  }
  return kept;
}

/// Several ranks share three scenes.
class BenchmarkRanksHeavy : public Benchmark {
 protected:
  BenchmarkRanksHeavy() { write_scene_folder(folder() / "set/c", small_scene(3), ""); }

  static Arguments benchmark_of(const std::string& scenes, const std::string& report) {
    return coarse({"benchmark", scenes, "--methods", "perch,bfwor", "--threads", "1", "-q", "-o", report});
  }

  Outcome run_ranks(int ranks, const Arguments& arguments) const {
    return run_command(folder(), ranks_command(ranks, arguments));
  }

  /// The first rank in the folder, the others elsewhere.
  Outcome run_apart(int ranks, const fs::path& elsewhere, const Arguments& arguments) const {
    Arguments command = ranks_command(1, arguments);
    const Arguments others{":", "-n", std::to_string(ranks - 1), "--wdir", elsewhere.string(), PERCH_PROGRAM};
    command.insert(command.end(), others.begin(), others.end());
    command.insert(command.end(), arguments.begin(), arguments.end());
    return run_command(folder(), std::move(command));
  }

  /// What lies in a report, as text, without what depends on the clock.
  std::map<std::string, std::string> timeless(const fs::path& report) const {
    std::map<std::string, std::string> files;
    for (const auto& [name, hash] : contents(folder() / report)) {
      std::string& file = files[name];
      if (name.ends_with("/result.json"))
        file = without_timings(json(report / name)).dump(1);
      else if (name == "evaluation.json")
        file = without_seconds(json(report / name)).dump(1);
      else if (name.ends_with(".png"))
        file = std::to_string(hash);
    }
    return files;
  }
};

TEST_F(BenchmarkRanksHeavy, FindTheSameAsOneProcessAndGoOnWithAnyNumber) {
  const Outcome one = run(benchmark_of("set", "one"));
  ASSERT_EQ(one.status, 0) << one;
  const auto files = timeless("one");
  EXPECT_EQ(files.count("bfwor/c/picture.png"), 1U);

  const Arguments arguments = benchmark_of("set", "many");
  const auto expect_same = [&](const Outcome& many) {
    ASSERT_EQ(many.status, 0) << many;
    EXPECT_EQ(many.err, "");
    EXPECT_EQ(timeless("many"), files);
  };
  expect_same(run_ranks(2, arguments));
  const std::string kept = bytes_of(folder() / "many/bfwor/a/result.json");
  for (const std::string result : {"perch/a", "perch/b", "bfwor/b", "perch/c"})
    fs::remove_all(folder() / "many" / result);
  // Who is started elsewhere finds the scenes, too.
  expect_same(run_apart(3, "/", arguments));
  fs::remove_all(folder() / "many/perch/c");
  expect_same(run_ranks(1, arguments));
  EXPECT_EQ(bytes_of(folder() / "many/bfwor/a/result.json"), kept);
}

TEST_F(BenchmarkRanksHeavy, SayWhichRankMissesAScene) {
  // A place that is another one in each process.
  const Arguments arguments = benchmark_of("/proc/self/cwd/set", "report");
  const Outcome outcome = run_apart(3, "/", arguments);
  EXPECT_EQ(outcome.status, 2) << outcome;
  EXPECT_THAT(outcome.err, ::testing::ContainsRegex("perch: rank [12] on [^ ]*: /proc/self/cwd/set/[abc]/"
                                                    "scene.yaml: no such file here; [^\n]*\n"));
  EXPECT_EQ(outcome.err.find("perch: "), outcome.err.rfind("perch: ")) << outcome;
  for (const auto& [name, hash] : contents(folder() / "report")) {
    EXPECT_THAT(name, Not(HasSubstr(".part")));
    if (name.ends_with("/result.json")) {
      EXPECT_TRUE(fs::exists((folder() / "report" / name).parent_path() / "picture.png"));
    }
  }
  // What the first made meanwhile is kept, the rest comes later.
  const Outcome rest = run(arguments);
  EXPECT_EQ(rest.status, 0) << rest;
}

#endif  // PERCH_MPIEXEC

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
