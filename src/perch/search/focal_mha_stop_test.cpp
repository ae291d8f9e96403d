#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "perch/search/focal_mha.hpp"
#include "perch/search/random_graphs_test_support.hpp"

namespace perch {
namespace {

using test::ExplicitGraph;
using test::look_up;
using ::testing::ElementsAre;

/// 0 -> 1 -> 2 -> ... at cost 1 each, without end.
struct Endless {
  using State = int;
  std::function<void(int)> before = [](int) {};
  int root() const { return 0; }
  bool is_goal(int) const { return false; }
  Expansion<int> expand(int v, const StopCondition&) const {
    before(v);
    return {{{v + 1, 1.0}, {v + 1, 1.0}}, true};
  }
};

TEST(FocalMhaStop, StopsForEachReasonWithATrueBound) {
  Endless endless;
  auto result = focal_mha(endless, {}, {}, StopCondition::after(-1));
  EXPECT_EQ(result.reason, StopReason::time);
  EXPECT_EQ(result.counters.expanded, 0U);
  EXPECT_EQ(result.lower_bound, 0);

  result = focal_mha(endless, {}, {.max_expansions = 0}, StopCondition());
  EXPECT_EQ(result.reason, StopReason::max_expansions);
  EXPECT_EQ(result.counters.expanded, 0U);

  result = focal_mha(endless, {}, {.max_expansions = 7}, StopCondition());
  EXPECT_EQ(result.reason, StopReason::max_expansions);
  EXPECT_EQ(result.lower_bound, 7);
  EXPECT_EQ(result.counters.generated, 14U);
  EXPECT_EQ(result.counters.duplicates, 7U);
  EXPECT_EQ(result.counters.peak_open, 1U);

  result = focal_mha(endless, {}, {.max_states = 100}, StopCondition());
  EXPECT_EQ(result.reason, StopReason::memory);
  EXPECT_EQ(result.lower_bound, 99);

  StopCondition stop;
  endless.before = [&](int v) {
    if (v == 4) stop.cancel();
  };
  result = focal_mha(endless, {}, {}, stop);
  EXPECT_EQ(result.reason, StopReason::cancelled);
  EXPECT_EQ(result.lower_bound, 5);
}

TEST(FocalMhaStop, EndsOnTimeInsideAnExpansion) {
  struct Slow {
    using State = int;
    int root() const { return 0; }
    bool is_goal(int v) const { return v == 9; }
    Expansion<int> expand(int, const StopCondition& stop) const {
      while (!stop()) {
      }
      return {{{9, 8.0}, {1, 1.0}}, false};
    }
  } slow;
  Heuristics<int> heuristics;
  heuristics.admissible = [](const int& v) { return v == 0 ? 2.0 : 7.0; };
  const auto result = focal_mha(slow, heuristics, {.w = 3}, StopCondition::after(0.01));
  EXPECT_EQ(result.reason, StopReason::time);
  EXPECT_EQ(result.counters.expanded, 0U);
  EXPECT_EQ(result.incumbent->cost, 8);  // its goals count
  EXPECT_EQ(result.lower_bound, 2);      // and the root is still open: state 1 doesn't stand for it
  EXPECT_EQ(focal_mha(slow, heuristics, {.w = 4}, StopCondition::after(0.01)).reason, StopReason::solved);
}

TEST(FocalMhaStop, InitialIncumbentEndsItAtOnceIfTheBoundAllows) {
  ExplicitGraph graph(3);
  graph.connect(0, 1, 5);
  graph.connect(1, 2, 5);
  graph.goal[2] = true;
  Heuristics<int> heuristics;
  heuristics.admissible = look_up({10, 5, 0});
  auto result = focal_mha(graph, heuristics, {.w = 1}, StopCondition(), {{2, 10.0}});
  EXPECT_EQ(result.reason, StopReason::solved);
  EXPECT_EQ(result.counters.expanded, 0U);
  EXPECT_EQ(result.incumbent->cost, 10);
  EXPECT_EQ(result.lower_bound, 10);
  EXPECT_TRUE(result.path.empty());

  result = focal_mha(graph, heuristics, {.w = 3}, StopCondition(), {{2, 30.0}});
  EXPECT_EQ(result.counters.expanded, 0U);
  EXPECT_EQ(result.incumbent->cost, 30);

  result = focal_mha(graph, heuristics, {.w = 3}, StopCondition(), {{2, 31.0}});
  EXPECT_EQ(result.incumbent->cost, 10);
  EXPECT_THAT(result.path, ElementsAre(0, 1, 2));

  // Cheaper than any path of the graph: the answer is itself, and the bound says no more than that.
  result = focal_mha(graph, heuristics, {.w = 3}, StopCondition(), {{2, 4.0}});
  EXPECT_EQ(result.incumbent->cost, 4);
  EXPECT_EQ(result.lower_bound, 4);
}

TEST(FocalMhaStop, InitialIncumbentPrunes) {
  ExplicitGraph graph(3);
  graph.connect(0, 1, 5);
  graph.connect(0, 2, 2);
  graph.goal[2] = true;
  const auto result = focal_mha(graph, {}, {.w = 1}, StopCondition(), {{2, 4.0}});
  EXPECT_EQ(result.incumbent->cost, 2);
  EXPECT_EQ(result.counters.expanded, 1U);
  EXPECT_EQ(result.counters.pruned, 1U);
}

}  // namespace
}  // namespace perch
