#include "ranks_test_support.hpp"

// `perch localize` on several MPI ranks.
namespace perch::command_line {
namespace {

using ::testing::HasSubstr;

/// Ends in Heavy: Open MPI itself is no work for sanitizers.
class RanksHeavy : public CommandLine {
 protected:
  Outcome run_ranks(int ranks, const Arguments& arguments) const {
    return run_command(folder(), ranks_command(ranks, arguments));
  }
};

TEST_F(RanksHeavy, GiveTheSameResultAsOneProcess) {
  using Ways = std::vector<std::pair<int, int>>;  // ranks, threads
  const std::vector<std::pair<Arguments, Ways>> runs{
      {{"--resolution", "0.03"}, {{1, 2}, {2, 1}, {3, 2}, {4, 1}}},
      {{"--search", "focal-mha", "--resolution", "0.06"}, {{3, 1}}},
      {{"--candidates", "context", "--w", "5", "--resolution", "0.06", "--yaw-resolution-deg", "45"},
       {{2, 1}, {4, 2}}}};
  for (const auto& [options, ways] : runs) {
    SCOPED_TRACE(options[0] + " " + options[1]);
    const auto localize = [&, &given = options](const std::string& output, int threads) {
      Arguments arguments{"localize", "scene.yaml", "-o", output, "-q", "--threads", std::to_string(threads)};
      arguments.insert(arguments.end(), given.begin(), given.end());
      return arguments;
    };
    const Outcome one = run(localize("one", 1));
    EXPECT_EQ(one.status, 0) << one;
    const Json result = json("one/result.json");
    EXPECT_EQ(result["stats"]["ranks"], 1);
    for (const auto& [ranks, threads] : ways) {
      SCOPED_TRACE(::testing::Message() << ranks << " ranks of " << threads << " threads");
      const Outcome many = run_ranks(ranks, localize("many", threads));
      EXPECT_EQ(many.status, 0) << many;
      const Json found = json("many/result.json");
      EXPECT_EQ(found["stats"]["ranks"], ranks);
      EXPECT_EQ(found["stats"]["threads"], threads);
      EXPECT_EQ(without_timings(found), without_timings(result));
      fs::remove_all(folder() / "many");
    }
  }
}

TEST_F(RanksHeavy, RefuseBadInputOnceAndEnd) {
  const auto before = contents(folder());
  const Outcome outcome = run_ranks(3, {"localize", "other.yaml", "-o", "out"});
  EXPECT_EQ(outcome.status, 2) << outcome;
  const std::string line = "perch: other.yaml: no such file";
  const std::size_t first = outcome.err.find(line);
  EXPECT_NE(first, std::string::npos) << outcome;
  EXPECT_EQ(outcome.err.find(line, first + 1), std::string::npos) << outcome;
  EXPECT_EQ(contents(folder()), before);
}

TEST_F(RanksHeavy, KeepTheTimeLimit) {
  const Outcome outcome = run_ranks(4, {"localize", "scene.yaml", "-o", "out", "-q", "--candidates",
                                        "context", "--w", "1", "--resolution", "0.01", "--time-limit", "1"});
  EXPECT_EQ(outcome.status, 3) << outcome;
  EXPECT_EQ(json("out/result.json")["status"], "time_limit");
}

/// Kills the rank of an MPI job whose program was started in this folder.
class Killer {
 public:
  Killer(fs::path folder, int rank) : folder_(std::move(folder)), rank_(rank) {}
  void operator()() {
    if (killed_) return;
    for (const auto& process : fs::directory_iterator("/proc")) {
      std::error_code none;
      if (fs::read_symlink(process.path() / "cwd", none) != folder_ ||
          fs::read_symlink(process.path() / "exe", none) != fs::path(PERCH_PROGRAM))
        continue;
      const std::string environment = bytes_of(process.path() / "environ");
      if (environment.find("OMPI_COMM_WORLD_RANK=" + std::to_string(rank_) + std::string(1, '\0')) ==
          std::string::npos)
        continue;
      if (first_seen_ == Clock::time_point()) first_seen_ = Clock::now();
      // Not before the search is on.
      if (Clock::now() - first_seen_ < std::chrono::seconds(1)) return;
      killed_ = kill(std::stoi(process.path().filename().string()), SIGKILL) == 0;
      return;
    }
  }
  bool killed() const { return killed_; }

 private:
  using Clock = std::chrono::steady_clock;
  fs::path folder_;
  int rank_;
  bool killed_ = false;
  Clock::time_point first_seen_;
};

TEST_F(RanksHeavy, EndTogetherWhereOneDies) {
  const auto before = contents(folder());
  for (const int rank : {0, 2}) {
    SCOPED_TRACE(::testing::Message() << "rank " << rank);
    Killer killer(fs::canonical(folder()), rank);
    const Outcome outcome =
        run_command(folder(),
                    ranks_command(3, {"localize", "scene.yaml", "-o", "out", "--candidates", "context", "--w",
                                      "1", "--resolution", "0.01", "--time-limit", "60"}),
                    std::chrono::seconds(50), std::ref(killer));
    EXPECT_TRUE(killer.killed());
    EXPECT_EQ(outcome.signal, 0) << outcome;
    EXPECT_GT(outcome.status, 0) << outcome;
    EXPECT_THAT(outcome.err, HasSubstr("signal 9"));
    EXPECT_EQ(contents(folder()), before) << "files were left behind";
  }
}

TEST_F(RanksHeavy, SayWhereTheyCannotMeet) {
  const Outcome outcome = run_command(
      folder(), {"env", "SLURM_STEP_NUM_TASKS=4", PERCH_PROGRAM, "localize", "scene.yaml", "-o", "out"});
  EXPECT_EQ(outcome.status, 2) << outcome;
  EXPECT_THAT(outcome.err, HasSubstr("--mpi=pmix"));
  EXPECT_FALSE(fs::exists(folder() / "out"));
}

}  // namespace
}  // namespace perch::command_line
