// Branch and bound in several processes, against one.

#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "local_team.hpp"
#include "perch/localize/localize.hpp"
#include "perch/localize/services.hpp"
#include "perch/search/branch_and_bound.hpp"
#include "perch/tree/scene_branching.hpp"
#include "small_problem.hpp"

namespace perch {
namespace {

using Found = SearchResult<SceneBranching::Solution>;

/// A search, and what was counted on the way.
struct Searched {
  Found found;
  Work work;
  std::vector<std::pair<std::uint64_t, double>> course;  ///< nodes expanded and lower bound after each batch
};

/// From nothing known, and weights that have hardly been improved, so that there is much to branch.
/// \param keeps renderings that are missing are made once, not for each node.
Searched search(const SmallProblem& small, CandidateSet candidates, const Executor& executor,
                const BranchAndBoundOptions& options, double share_after, bool keeps = true) {
  std::vector<CandidateMaker> makers = make_makers(*small.problem, executor);
  LagrangianBound bound(*small.problem, candidates);
  bound.improve(3, std::int64_t{1} << 30, 1e9, executor, StopCondition());
  StopCondition keeping;
  if (!keeps) keeping.cancel();
  SceneBranching branching(*small.problem, candidates, makers, executor, bound, keeping, share_after);
  Searched searched;
  SearchObserver<SceneBranching::Solution> observer;
  observer.on_expansion = [&](const SearchProgress& p) {
    searched.course.emplace_back(p.expanded, p.lower_bound);
  };
  searched.found = branch_and_bound(branching, options, StopCondition(), std::nullopt, observer);
  Effort effort;
  for (const CandidateMaker& maker : makers) effort += maker.effort();
  searched.work = effort.work;
  return searched;
}

void expect_same(const Searched& one, const Searched& other) {
  EXPECT_EQ(other.found.reason, one.found.reason);
  EXPECT_EQ(other.found.lower_bound, one.found.lower_bound);
  EXPECT_EQ(other.found.counters.expanded, one.found.counters.expanded);
  EXPECT_EQ(other.found.counters.generated, one.found.counters.generated);
  ASSERT_EQ(other.found.incumbent.has_value(), one.found.incumbent.has_value());
  if (one.found.incumbent) {
    EXPECT_EQ(other.found.incumbent->state, one.found.incumbent->state);
    EXPECT_EQ(other.found.incumbent->cost, one.found.incumbent->cost);
  }
  EXPECT_EQ(other.course, one.course);
  EXPECT_EQ(other.work, one.work);
}

TEST(SharedBranching, SearchesAsOneProcessDoes) {
  Random random(20241);
  std::uint64_t expanded = 0, items = 0, bytes = 0, renderings = 0;
  for (int problem = 0; problem < 6; ++problem) {
    const std::uint64_t seed = random.below(1'000'000);
    const bool repeats = random.below(3) == 0, optional = random.below(3) == 0;
    SCOPED_TRACE(testing::Message() << "seed " << seed << (repeats ? ", repeats" : "")
                                    << (optional ? ", optional" : ""));
    SmallProblem small(seed, random.below(2) == 0, RefineMethod::icp, 4 + static_cast<int>(random.below(2)),
                       repeats, optional);
    // What a process of several has: some candidates with their renderings, some without that it may draw
    // for nothing, and some that it must count.
    CandidateSet one = small.set, several = small.set;
    for (CandidateId id = 0; id < small.set.size(); ++id) {
      const std::uint64_t kind = random.below(3);
      if (kind > 0 || one[id].absent) several[id].patch = {};
      if (kind == 1 && !one[id].absent) several[id].drawn_elsewhere = true;
      if (kind == 2) one[id].patch = {};
    }
    BranchAndBoundOptions options;
    if (random.below(2) == 0) options.max_expansions = 5 + random.below(80);
    const bool keeps = problem % 2 == 0;
    const Searched alone = search(small, one, SerialExecutor(), options, 0.0, keeps);
    expanded += alone.found.counters.expanded;
    renderings += static_cast<std::uint64_t>(alone.work.renderings);
    const std::size_t processes = 2 + random.below(3), threads = 1 + random.below(2);
    SCOPED_TRACE(testing::Message() << processes << " processes of " << threads << " threads");
    LocalTeam team(processes, threads, localization_services);
    tell_problem(small.simulated.scene, small.settings, team.executor());
    for (const double share_after : {0.0, 0.01, 1e9}) {
      if (share_after == 1e9 && problem > 0) continue;
      SCOPED_TRACE(testing::Message() << "shared after " << share_after << " s");
      const Traffic before = team.executor().traffic();
      expect_same(alone, search(small, several, team.executor(), options, share_after, keeps));
      const Traffic after = team.executor().traffic();
      if (share_after == 1e9) {
        EXPECT_EQ(after.items, before.items);
      }
      items += after.items - before.items;
      bytes += after.bytes - before.bytes - (after.news_bytes - before.news_bytes);
    }
  }
  std::printf("%llu nodes, %llu renderings; %llu nodes worked on elsewhere, %llu bytes each\n",
              static_cast<unsigned long long>(expanded), static_cast<unsigned long long>(renderings),
              static_cast<unsigned long long>(items),
              static_cast<unsigned long long>(bytes / std::max<std::uint64_t>(1, items)));
  EXPECT_GT(expanded, 50U);
  EXPECT_GT(items, 50U);
  EXPECT_GT(renderings, expanded);  // some were counted again for each node
}

TEST(SharedBranching, StopsWithinAFewNodesAndGoesOn) {
  SmallProblem small(7, true, RefineMethod::none, 4);
  LocalTeam team(3, 1, localization_services);
  tell_problem(small.simulated.scene, small.settings, team.executor());
  const Searched alone = search(small, small.set, SerialExecutor(), {}, 0.0);
  ASSERT_GT(alone.found.counters.expanded, 10U);
  for (const double seconds : {0.0, 0.005, 0.02}) {
    std::vector<CandidateMaker> makers = make_makers(*small.problem, team.executor());
    const LagrangianBound bound(*small.problem, small.set);
    const StopCondition stop = StopCondition::after(seconds);
    SceneBranching branching(*small.problem, small.set, makers, team.executor(), bound, StopCondition(), 0.0);
    const Found found = branch_and_bound(branching, {}, stop);
    EXPECT_LE(found.lower_bound, alone.found.lower_bound);
    if (found.reason == StopReason::time) {
      EXPECT_TRUE(stop.out_of_time());
    } else {
      EXPECT_EQ(found.lower_bound, alone.found.lower_bound);
    }
  }
  expect_same(alone, search(small, small.set, team.executor(), {}, 0.0));
}

}  // namespace
}  // namespace perch
