#include "perch/search/focal_mha.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <limits>
#include <stdexcept>
#include <vector>

#include "perch/search/random_graphs_test_support.hpp"

namespace perch {
namespace {

using test::ExplicitGraph;
using test::infinity;
using test::look_up;
using ::testing::ElementsAre;

struct NoExpand {
  using State = int;
  int root() const { return 0; }
  bool is_goal(int) const { return true; }
};
struct NoStop : NoExpand {
  Expansion<int> expand(int) const { return {}; }
};
struct OtherStates : NoExpand {
  Expansion<double> expand(int, const StopCondition&) const { return {}; }
};
struct NoHash {
  struct State {
    int value = 0;
    bool operator==(const State&) const = default;
  };
  State root() const { return {}; }
  bool is_goal(const State&) const { return true; }
  Expansion<State> expand(const State&, const StopCondition&) const { return {}; }
};

static_assert(SearchProblem<ExplicitGraph>);
static_assert(!SearchProblem<int>);
static_assert(!SearchProblem<NoExpand>);
static_assert(!SearchProblem<NoStop>);
static_assert(!SearchProblem<OtherStates>);
static_assert(!SearchProblem<NoHash>);

TEST(FocalMha, KeepsZeroCostEdges) {
  ExplicitGraph graph(4);
  graph.connect(0, 1, 0);
  graph.connect(1, 0, 0);  // a cycle of no cost
  graph.connect(1, 2, 0);
  graph.connect(2, 3, 0);
  graph.goal[3] = true;
  const auto result = focal_mha(graph, {}, {}, StopCondition());
  EXPECT_EQ(result.reason, StopReason::solved);
  EXPECT_EQ(result.incumbent->cost, 0);
  EXPECT_EQ(result.lower_bound, 0);
  EXPECT_THAT(result.path, ElementsAre(0, 1, 2, 3));
}

TEST(FocalMha, EqualStatesKeepTheCheaperPath) {
  ExplicitGraph graph(5);
  graph.connect(0, 1, 1);
  graph.connect(0, 2, 1);
  graph.connect(1, 3, 5);  // seen first
  graph.connect(2, 3, 2);
  graph.connect(3, 4, 1);
  graph.goal[4] = true;
  const auto result = focal_mha(graph, {}, {.w = 1}, StopCondition());
  EXPECT_EQ(result.incumbent->cost, 4);
  EXPECT_THAT(result.path, ElementsAre(0, 2, 3, 4));
  EXPECT_EQ(result.counters.duplicates, 0U);
  EXPECT_EQ(result.counters.reopened, 0U);  // it was cheaper before it was expanded
}

TEST(FocalMha, RootThatIsAGoalIsTheAnswer) {
  ExplicitGraph graph(1);
  graph.goal[0] = true;
  const auto result = focal_mha(graph, {}, {}, StopCondition());
  EXPECT_EQ(result.reason, StopReason::solved);
  EXPECT_EQ(result.incumbent->cost, 0);
  EXPECT_THAT(result.path, ElementsAre(0));
  EXPECT_EQ(graph.asked, 0U);
}

TEST(FocalMha, InfiniteAdmissibleHeuristicIsADeadEnd) {
  ExplicitGraph graph(3);
  graph.connect(0, 1, 1);
  graph.connect(1, 2, 1);
  Heuristics<int> heuristics;
  heuristics.admissible = look_up({0, infinity, infinity});
  auto result = focal_mha(graph, heuristics, {}, StopCondition());
  EXPECT_EQ(result.reason, StopReason::infeasible);
  EXPECT_EQ(result.counters.expanded, 1U);
  EXPECT_EQ(result.counters.pruned, 1U);
  heuristics.admissible = look_up({infinity, 0, 0});
  result = focal_mha(graph, heuristics, {}, StopCondition());
  EXPECT_EQ(result.reason, StopReason::infeasible);
  EXPECT_EQ(result.counters.expanded, 0U);
}

TEST(FocalMha, PathmaxKeepsTheBoundOfTheParent) {
  ExplicitGraph graph(3);
  graph.connect(0, 1, 1);
  graph.connect(1, 2, 9);
  graph.goal[2] = true;
  Heuristics<int> heuristics;
  heuristics.admissible = look_up({10, 0, 0});
  const auto result = focal_mha(graph, heuristics, {.w = 1, .max_expansions = 1}, StopCondition());
  EXPECT_EQ(result.lower_bound, 10);
}

/// Two parents of state 3, each first in an inadmissible queue of its own. 2 is far from any goal and knows
/// it; 3 itself doesn't.
TEST(FocalMha, ReachedAgainWithALargerBoundTheLargerCounts) {
  Heuristics<int> heuristics;
  heuristics.admissible = look_up({0, 0, 9, 0});
  heuristics.inadmissible = {look_up({0, 1, 2, 3}), look_up({0, 2, 1, 3})};
  for (const double second : {1.0, 3.0}) {  // at the same cost as by 1; by a dearer path
    ExplicitGraph graph(4);
    graph.connect(0, 1, 1);
    graph.connect(0, 2, 1);
    graph.connect(1, 3, 1);
    graph.connect(2, 3, second);
    auto result = focal_mha(graph, heuristics, {.w = 10, .max_expansions = 2}, StopCondition());
    EXPECT_EQ(result.lower_bound, 2);  // 3 at f = 2 + 0
    result = focal_mha(graph, heuristics, {.w = 10, .max_expansions = 3}, StopCondition());
    EXPECT_EQ(result.counters.duplicates, 1U);
    EXPECT_EQ(result.lower_bound, 2 + 9 - second);
  }
}

/// The anchor (h = 0) and one inadmissible queue take turns at w = 2:
///
///     root(0) -1-> A(1) -0-> S(2) -0-> M(3) -0-> T(4) -0-> goal(5),   also   root -2-> S,   root -4-> T
///
/// anchor: root. FOCAL is f <= 2, and the inadmissible queue takes S at g = 2, so M is open at 2. The
/// anchor takes A, which reaches S again at 1.
/// Not put back, S leaves min f at M's 2 where the truth is 1; FOCAL becomes f <= 4, the inadmissible queue
/// takes T at g = 4, and the goal at 4 passes for solved (4 <= 2 * 2) though the optimum is 1.
TEST(FocalMha, StateExpandedByAnInadmissibleQueueIsReopened) {
  ExplicitGraph graph(6);
  graph.connect(0, 1, 1);
  graph.connect(0, 2, 2);
  graph.connect(0, 4, 4);
  graph.connect(1, 2, 0);
  graph.connect(2, 3, 0);
  graph.connect(3, 4, 0);
  graph.connect(4, 5, 0);
  graph.goal[5] = true;
  Heuristics<int> heuristics;
  heuristics.inadmissible = {look_up({0, 50, 1, 99, 2, 0})};
  auto result = focal_mha(graph, heuristics, {.w = 2, .max_expansions = 2}, StopCondition());
  EXPECT_EQ(result.counters.expanded_inadmissible, 1U);
  EXPECT_EQ(result.counters.reopened, 0U);
  result = focal_mha(graph, heuristics, {.w = 2, .max_expansions = 3}, StopCondition());
  EXPECT_EQ(result.counters.reopened, 1U);
  EXPECT_EQ(result.lower_bound, 1);
  result = focal_mha(graph, heuristics, {.w = 2}, StopCondition());
  EXPECT_LE(result.incumbent->cost, 2);
  EXPECT_EQ(result.lower_bound, 1);
  EXPECT_EQ(test::path_cost(graph, result.path), result.incumbent->cost);
}

/// A goal found behind a stale state costs what its path costs by now. At w = 10 the inadmissible queue takes
/// S(2) at g = 5 and opens M(3); the anchor takes A(1), so S is open again at 1 while M still stands at 5;
/// the inadmissible queue takes M, and the goal behind it is reached by root, A, S, M at 2.
TEST(FocalMha, IncumbentCostsWhatItsPathCosts) {
  ExplicitGraph graph(5);
  graph.connect(0, 1, 1);
  graph.connect(0, 2, 5);
  graph.connect(1, 2, 0);
  graph.connect(2, 3, 0);
  graph.connect(3, 4, 1);
  graph.goal[4] = true;
  Heuristics<int> heuristics;
  heuristics.inadmissible = {look_up({0, 50, 2, 1, 0})};
  const auto result = focal_mha(graph, heuristics, {.w = 10}, StopCondition());
  EXPECT_EQ(result.counters.expanded, 4U);
  EXPECT_EQ(result.incumbent->cost, 2);
  EXPECT_THAT(result.path, ElementsAre(0, 1, 2, 3, 4));
}

TEST(FocalMha, QueuesTakeTurnsAndBreakTiesByF) {
  ExplicitGraph graph(4);
  graph.connect(0, 1, 2);
  graph.connect(0, 2, 1);
  graph.connect(0, 3, 2);
  std::vector<int> order;
  struct Recorder {
    using State = int;
    ExplicitGraph& graph;
    std::vector<int>& order;
    int root() const { return 0; }
    bool is_goal(int v) const { return graph.is_goal(v); }
    Expansion<int> expand(int v, const StopCondition& stop) {
      order.push_back(v);
      return graph.expand(v, stop);
    }
  } recorder{graph, order};
  Heuristics<int> heuristics;
  heuristics.inadmissible = {look_up({0, 1, 1, 0})};
  focal_mha(recorder, heuristics, {.w = 2}, StopCondition());
  EXPECT_THAT(order, ElementsAre(0, 3, 2, 1));
  order.clear();
  focal_mha(recorder, heuristics, {.w = 1}, StopCondition());  // 3 must wait until min f reaches its f
  EXPECT_THAT(order, ElementsAre(0, 2, 1, 3));
}

TEST(FocalMha, AnchorPrefersTheLargerGAmongEqualF) {
  ExplicitGraph graph(4);
  graph.connect(0, 1, 1);
  graph.connect(0, 2, 3);
  graph.connect(2, 3, 1);
  graph.goal[3] = true;
  Heuristics<int> heuristics;
  heuristics.admissible = look_up({4, 3, 1, 0});
  const auto result = focal_mha(graph, heuristics, {.w = 1}, StopCondition());
  EXPECT_EQ(result.incumbent->cost, 4);
  EXPECT_EQ(result.counters.expanded, 2U);
}

TEST(FocalMha, RefusesWhatItsContractExcludes) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ExplicitGraph graph(2);
  graph.goal[1] = true;
  for (const double cost : {-1.0, nan, infinity}) {
    graph.edges[0] = {{1, cost}};
    EXPECT_THROW(focal_mha(graph, {}, {}, StopCondition()), std::logic_error);
    EXPECT_THROW(focal_mha(graph, {}, {}, StopCondition(), {{1, cost}}), std::logic_error);
  }
  graph.edges[0] = {{1, 1.0}};
  EXPECT_THROW(focal_mha(graph, {}, {}, StopCondition(), {{0, 1.0}}), std::logic_error);
  for (const double value : {-1.0, nan}) {
    Heuristics<int> heuristics;
    heuristics.admissible = look_up({value, 0});
    EXPECT_THROW(focal_mha(graph, heuristics, {}, StopCondition()), std::logic_error);
    heuristics.admissible = look_up({0, 0});
    heuristics.inadmissible = {look_up({value, 0})};
    EXPECT_THROW(focal_mha(graph, heuristics, {}, StopCondition()), std::logic_error);
  }
  for (const double w : {0.99, -1.0, nan, infinity})
    EXPECT_THROW(focal_mha(graph, {}, {.w = w}, StopCondition()), InvalidSetting);
  EXPECT_THROW(focal_mha(graph, {}, {.max_states = 0}, StopCondition()), InvalidSetting);
}

/// States with a type and a hash of their own; the hash is the worst there is.
struct Cell {
  int x = 0, y = 0;
  bool operator==(const Cell&) const = default;
};

}  // namespace
}  // namespace perch

template <>
struct std::hash<perch::Cell> {
  std::size_t operator()(const perch::Cell&) const { return 1; }
};

namespace perch {
namespace {

/// Steps right and up on a grid, to its far corner. Every cell is reached by two paths of the same cost.
struct Grid {
  using State = Cell;
  int size = 12;
  Cell root() const { return {}; }
  bool is_goal(const Cell& c) const { return c.x == size && c.y == size; }
  Expansion<Cell> expand(const Cell& c, const StopCondition&) const {
    Expansion<Cell> expansion;
    if (c.x < size) expansion.edges.push_back({{c.x + 1, c.y}, 1.0});
    if (c.y < size) expansion.edges.push_back({{c.x, c.y + 1}, 1.0});
    return expansion;
  }
};

TEST(FocalMha, EqualStatesAreOneWhateverTheirHash) {
  Grid grid;
  const auto result = focal_mha(grid, {}, {.w = 1}, StopCondition());
  EXPECT_EQ(result.incumbent->cost, 24);
  EXPECT_EQ(result.path.size(), 25U);
  EXPECT_LE(result.counters.expanded, 13U * 13U);
  EXPECT_EQ(result.counters.duplicates, 12U * 12U - 1);
}

/// Dead queue entries outnumber the live ones here many times over: every state is opened often.
TEST(FocalMha, ReopeningOftenKeepsTheOrderRight) {
  constexpr int n = 60;
  ExplicitGraph graph(n + 1);
  // The paths to v that visit more of 0 .. v are cheaper, by one for each state visited.
  for (int from = 0; from < n; ++from)
    for (int to = from + 1; to <= n; ++to) graph.connect(from, to, 2.0 * (to - from) - 1.0);
  graph.goal[n] = true;
  Heuristics<int> heuristics;
  heuristics.inadmissible = {[](const int& v) { return static_cast<double>(n - v); }};
  const auto result = focal_mha(graph, heuristics, {.w = 1.9}, StopCondition());
  EXPECT_GE(result.incumbent->cost, n);
  EXPECT_LE(result.incumbent->cost, 1.9 * n);
  EXPECT_LE(result.lower_bound, n);
  EXPECT_GT(result.counters.reopened, 0U);
}

}  // namespace
}  // namespace perch
