#include "perch/search/branch_and_bound.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "perch/core/random.hpp"
#include "perch/search/random_graphs_test_support.hpp"

namespace perch {
namespace {

using test::infinity;

/// Every node has `width` children, without end. Bounds are depths.
struct EndlessBranching {
  struct Node {
    int depth = 0;
  };
  using Solution = int;
  int width = 1;
  std::function<void(const Node&)> before = [](const Node&) {};

  Node root() const { return {}; }
  double bound(const Node& node) const { return node.depth; }
  std::vector<Branching<Node, Solution>> branch(const std::vector<Node>& nodes, double,
                                                const StopCondition&) {
    std::vector<Branching<Node, Solution>> answers;
    for (const Node& node : nodes) {
      before(node);
      answers.emplace_back().children.assign(static_cast<std::size_t>(width), Node{node.depth + 1});
    }
    return answers;
  }
};

TEST(BranchAndBound, StopsForEachReasonWithATrueBound) {
  EndlessBranching endless;
  auto result = branch_and_bound(endless, {}, StopCondition::after(-1));
  EXPECT_EQ(result.reason, StopReason::time);
  EXPECT_EQ(result.counters.expanded, 0U);
  EXPECT_EQ(result.lower_bound, 0);
  EXPECT_FALSE(result.incumbent);

  result = branch_and_bound(endless, {.max_expansions = 0}, StopCondition());
  EXPECT_EQ(result.reason, StopReason::max_expansions);
  EXPECT_EQ(result.lower_bound, 0);

  result = branch_and_bound(endless, {.max_expansions = 7}, StopCondition());
  EXPECT_EQ(result.reason, StopReason::max_expansions);
  EXPECT_EQ(result.counters.expanded, 7U);
  EXPECT_EQ(result.lower_bound, 7);

  endless.width = 3;
  result = branch_and_bound(endless, {.max_open = 100}, StopCondition());
  EXPECT_EQ(result.reason, StopReason::memory);
  EXPECT_EQ(result.lower_bound, 4);  // each node adds two: the 40 nodes above depth 4 leave 81
  EXPECT_GE(result.counters.peak_open, 100U);
  EXPECT_LT(result.counters.peak_open, 100U + 2 * 8);

  endless.width = 1;
  StopCondition stop;
  endless.before = [&](const EndlessBranching::Node& node) {
    if (node.depth == 4) stop.cancel();
  };
  result = branch_and_bound(endless, {}, stop);
  EXPECT_EQ(result.reason, StopReason::cancelled);
  EXPECT_EQ(result.lower_bound, 5);
}

TEST(BranchAndBound, EndsOnTimeInsideABatch) {
  struct Slow {
    using Node = int;
    using Solution = int;
    int root() const { return 0; }
    double bound(int) const { return 2.0; }
    std::vector<Branching<int, int>> branch(const std::vector<int>& nodes, double,
                                            const StopCondition& stop) {
      while (!stop()) {
      }
      Branching<int, int> answer;
      answer.found = {1, 8.0};
      answer.complete = false;
      return std::vector(nodes.size(), answer);
    }
  } slow;
  auto result = branch_and_bound(slow, {.w = 3}, StopCondition::after(0.01));
  EXPECT_EQ(result.reason, StopReason::time);
  EXPECT_EQ(result.counters.expanded, 0U);
  EXPECT_EQ(result.lower_bound, 2);
  ASSERT_TRUE(result.incumbent);
  EXPECT_EQ(result.incumbent->cost, 8);  // what was found counts
  result = branch_and_bound(slow, {.w = 4}, StopCondition::after(0.01));
  EXPECT_EQ(result.reason, StopReason::solved) << "the limit came, but what was found is good enough";
}

TEST(BranchAndBound, InitialIncumbentEndsItAtOnceIfTheBoundAllows) {
  EndlessBranching endless;
  endless.before = [](const EndlessBranching::Node&) { ADD_FAILURE(); };
  auto result = branch_and_bound(endless, {}, StopCondition(), Incumbent<int>{5, 0.0});
  EXPECT_EQ(result.reason, StopReason::solved);
  EXPECT_EQ(result.incumbent->state, 5);
  EXPECT_EQ(result.lower_bound, 0);
  endless.before = [](const EndlessBranching::Node&) {};
  // Solutions may be cheaper than what is known up to a depth of 10.
  result = branch_and_bound(endless, {.w = 2}, StopCondition(), Incumbent<int>{5, 10.0});
  EXPECT_EQ(result.lower_bound, 5);
  EXPECT_EQ(result.counters.expanded, 5U);
  result = branch_and_bound(endless, {}, StopCondition(), Incumbent<int>{5, 10.0});
  EXPECT_EQ(result.lower_bound, 10);
  EXPECT_EQ(result.counters.expanded, 10U);
  EXPECT_EQ(result.counters.pruned, 1U);
}

/// Many children of the root, without children of their own: 0 is the root, others are their bounds.
struct Flat {
  using Node = double;
  using Solution = double;
  Random random;
  std::vector<double> worked_on = {};

  double root() const { return 0.0; }
  double bound(double node) const { return node; }
  std::vector<Branching<double, double>> branch(const std::vector<double>& nodes, double,
                                                const StopCondition&) {
    std::vector<Branching<double, double>> answers(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      worked_on.push_back(nodes[i]);
      if (nodes[i] == 0.0)
        for (int child = 0; child < 500; ++child) answers[i].children.push_back(random.uniform(1, 1000));
      else
        answers[i].found = {nodes[i], random.uniform(nodes[i], 1100)};
    }
    return answers;
  }
};

// Better and better solutions make most of OPEN useless; what is left still comes in order.
TEST(BranchAndBound, KeepsTheOrderWhenNodesArePruned) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Flat problem{Random(seed)};
    const auto result = branch_and_bound(problem, {.batch = 1}, StopCondition());
    EXPECT_TRUE(std::is_sorted(problem.worked_on.begin(), problem.worked_on.end()));
    EXPECT_EQ(result.counters.expanded + result.counters.pruned, 501U) << "worked on or pruned, once each";
  }
}

/// One node with the bound and the answers given.
struct OneNode {
  using Node = int;
  using Solution = int;
  double bound_ = 0.0;
  std::vector<Branching<int, int>> answers;
  int root() const { return 0; }
  double bound(int) const { return bound_; }
  std::vector<Branching<int, int>> branch(const std::vector<int>&, double, const StopCondition&) {
    return answers;
  }
};

TEST(BranchAndBound, RefusesWhatBreaksTheContract) {
  const double nan = std::nan("");
  const auto run = [](OneNode problem, const BranchAndBoundOptions& options = {},
                      std::optional<Incumbent<int>> initial = std::nullopt) {
    return branch_and_bound(problem, options, StopCondition(), std::move(initial));
  };
  const auto found = [](double cost) {
    Branching<int, int> answer;
    answer.found = {0, cost};
    return std::vector{answer};
  };
  EXPECT_EQ(run({0.0, found(3.0)}).incumbent->cost, 3.0);
  EXPECT_EQ(run({infinity, {}}).reason, StopReason::infeasible);
  for (const double bad : {-1.0, nan, -infinity}) {
    EXPECT_THROW(run({bad, found(3.0)}), std::logic_error) << bad;
    EXPECT_THROW(run({0.0, found(bad)}), std::logic_error) << bad;
    EXPECT_THROW(run({0.0, found(3.0)}, {}, Incumbent<int>{0, bad}), std::logic_error) << bad;
  }
  EXPECT_THROW(run({0.0, found(infinity)}), std::logic_error);
  EXPECT_THROW(run({0.0, found(3.0)}, {}, Incumbent<int>{0, infinity}), std::logic_error);
  EXPECT_THROW(run({0.0, {}}), std::logic_error) << "no answer";
  EXPECT_THROW(run({0.0, std::vector(2, found(3.0).front())}), std::logic_error) << "two answers for a node";
  for (const double w : {0.99, -3.0, nan, infinity})
    EXPECT_THROW(run({0.0, found(3.0)}, {.w = w}), InvalidSetting) << w;
  for (const std::size_t batch : {0, 4097})
    EXPECT_THROW(run({0.0, found(3.0)}, {.batch = batch}), InvalidSetting) << batch;
}

}  // namespace
}  // namespace perch
