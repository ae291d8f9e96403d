#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "perch/core/random.hpp"
#include "perch/search/branch_and_bound.hpp"
#include "perch/search/random_graphs_test_support.hpp"

namespace perch {
namespace {

using test::factors;
using test::infinity;
constexpr std::size_t batches[] = {1, 3, 8, 100};

/// How bounds relate to the cheapest solution below a node.
enum class Bounds {
  zero,     ///< nothing is known
  exact,    ///< the cheapest solution's cost
  fraction  ///< an independent random part of it at each node: children may promise less than their parent
};
constexpr Bounds kinds[] = {Bounds::zero, Bounds::exact, Bounds::fraction};

/// A branching problem in full: nodes 0 .. n - 1, of which some hold a solution of their own.
class ExplicitProblem {
 public:
  using Node = int;
  using Solution = int;  ///< the node that holds it
  using Answers = std::vector<Branching<Node, Solution>>;
  /// A node that must never be asked about.
  static constexpr int poison = -1;

  ExplicitProblem(std::uint64_t seed, Bounds kind) : random_(seed) {
    const std::size_t nodes = 1 + random_.below(random_.uniform() < 0.1 ? 500 : 60);
    const std::uint64_t dearest = 1 + random_.below(random_.uniform() < 0.3 ? 2000 : 40);
    const double zeros = random_.uniform() < 0.3 ? 0.5 : 0.05;
    const double solutions = random_.uniform() < 0.2 ? 0.03 : 0.4;
    const bool deep = random_.uniform() < 0.5;
    children_.resize(nodes);
    for (std::size_t v = 1; v < nodes; ++v) {
      const std::size_t first = deep ? v - std::min<std::size_t>(v, 3) : 0;
      children_[first + random_.below(v - first)].push_back(static_cast<int>(v));
    }
    for (std::size_t v = 0; v < nodes; ++v) {
      const double cost = random_.uniform() < zeros ? 0.0 : static_cast<double>(random_.below(dearest + 1));
      own_.push_back(random_.uniform() < solutions ? cost : infinity);
    }
    best_ = own_;
    for (std::size_t v = nodes; v-- > 0;)  // children have higher numbers
      for (const int child : children_[v]) best_[v] = std::min(best_[v], best_[index(child)]);
    for (std::size_t v = 0; v < nodes; ++v) bounds_.push_back(bound_of(v, kind));
    drops_dear_children_ = random_.uniform() < 0.5;
    looks_ahead_ = random_.uniform() < 0.5;
    path_bounds_.assign(nodes, 0.0);
    path_bounds_[0] = bounds_[0];
  }

  int root() const { return 0; }
  double bound(int node) const {
    if (node == poison) ADD_FAILURE() << "a child of a node that was not finished";
    return bounds_[index(node)];
  }
  Answers branch(const std::vector<int>& nodes, double upper_bound, const StopCondition&) {
    ++batches_;
    largest_batch_ = std::max(largest_batch_, nodes.size());
    Answers answers;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const int node = nodes[i];
      branched_ += 1;
      if (i == 0) first_bounds_.push_back(path_bounds_[index(node)]);
      Branching<int, int> answer;
      for (const int child : children_[index(node)]) {
        path_bounds_[index(child)] = std::max(path_bounds_[index(node)], bounds_[index(child)]);
        if (!drops_dear_children_ || best_[index(child)] < upper_bound) answer.children.push_back(child);
      }
      if (own_[index(node)] < infinity) answer.found = {node, own_[index(node)]};
      if (looks_ahead_) {  // a solution somewhere below, found on the way
        int below = node;
        while (!children_[index(below)].empty() && random_.uniform() < 0.7)
          below = children_[index(below)][random_.below(children_[index(below)].size())];
        if (own_[index(below)] < (answer.found ? answer.found->cost : infinity))
          answer.found = {below, own_[index(below)]};
      }
      if (on_answer) on_answer(answer);
      answers.push_back(std::move(answer));
    }
    return answers;
  }

  /// By looking at every node.
  double optimum() const { return *std::min_element(own_.begin(), own_.end()); }
  double cost(int solution) const { return own_[index(solution)]; }
  std::uint64_t branched() const { return branched_; }
  std::uint64_t batches() const { return batches_; }
  std::size_t largest_batch() const { return largest_batch_; }
  /// Of the first node of each batch: the highest bound on the way from the root.
  const std::vector<double>& first_bounds() const { return first_bounds_; }
  Random& random() { return random_; }
  void scale(double factor) {
    for (auto* values : {&own_, &best_, &bounds_, &path_bounds_})
      for (double& value : *values) value *= factor;
  }
  std::function<void(Branching<int, int>&)> on_answer;

 private:
  static std::size_t index(int node) { return static_cast<std::size_t>(node); }
  double bound_of(std::size_t v, Bounds kind) {
    if (kind == Bounds::zero) return 0.0;
    if (kind == Bounds::exact) return best_[v];
    if (best_[v] == infinity) return random_.uniform() < 0.5 ? infinity : random_.uniform(0, 60);
    return random_.uniform() < 0.3 ? best_[v] : std::floor(best_[v] * random_.uniform());
  }

  Random random_;
  std::vector<std::vector<int>> children_;
  std::vector<double> own_, best_, bounds_, path_bounds_;
  bool drops_dear_children_ = false, looks_ahead_ = false;
  std::uint64_t branched_ = 0, batches_ = 0;
  std::size_t largest_batch_ = 0;
  std::vector<double> first_bounds_;
};

/// Calls check(problem, options) for every kind of bounds, w and batch, on a problem of its own each, and
/// names the seed of what fails.
template <typename Check>
void for_random_problems(std::uint64_t seeds, const Check& check) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed)
    for (const Bounds kind : kinds)
      for (const double w : factors)
        for (const std::size_t batch : batches) {
          SCOPED_TRACE("seed " + std::to_string(seed) + ", bounds " + std::to_string(static_cast<int>(kind)) +
                       ", w " + std::to_string(w) + ", batch " + std::to_string(batch));
          ExplicitProblem problem(seed, kind);
          check(problem, BranchAndBoundOptions{.w = w, .batch = batch});
          if (::testing::Test::HasFailure()) return;
        }
}

/// What holds whatever the reason of the stop.
void expect_true_result(const ExplicitProblem& problem, const SearchResult<int>& result) {
  EXPECT_LE(result.lower_bound, problem.optimum());
  EXPECT_GE(result.lower_bound, 0.0);
  if (!result.incumbent) return;
  EXPECT_EQ(result.incumbent->cost, problem.cost(result.incumbent->state));
  EXPECT_LE(result.lower_bound, result.incumbent->cost);
}

TEST(BranchAndBoundProperty, CostsAtMostWTimesTheOptimum) {
  int infeasible = 0, zero = 0;
  for_random_problems(400, [&](ExplicitProblem& problem, const BranchAndBoundOptions& options) {
    const auto result = branch_and_bound(problem, options, StopCondition());
    expect_true_result(problem, result);
    const double optimum = problem.optimum();
    EXPECT_EQ(result.counters.expanded, problem.branched());
    EXPECT_LE(problem.largest_batch(), options.batch);
    if (optimum == infinity) {
      ++infeasible;
      EXPECT_EQ(result.reason, StopReason::infeasible);
      EXPECT_FALSE(result.incumbent);
      EXPECT_EQ(result.lower_bound, infinity);
      return;
    }
    zero += optimum == 0.0;
    EXPECT_EQ(result.reason, StopReason::solved);
    ASSERT_TRUE(result.incumbent);
    EXPECT_LE(result.incumbent->cost, options.w * optimum);
    EXPECT_LE(result.incumbent->cost, options.w * result.lower_bound);
    if (options.w == 1.0) {
      EXPECT_EQ(result.incumbent->cost, optimum);
      EXPECT_EQ(result.lower_bound, optimum);
    }
  });
  EXPECT_GT(infeasible, 100);
  EXPECT_GT(zero, 100);
}

// Best first: the first node of a batch promises no more than the optimum costs.
TEST(BranchAndBoundProperty, WorksOnTheMostPromisingNodes) {
  for_random_problems(100, [](ExplicitProblem& problem, const BranchAndBoundOptions& options) {
    branch_and_bound(problem, options, StopCondition());
    double last = 0.0;
    for (const double bound : problem.first_bounds()) {
      EXPECT_LE(bound, problem.optimum());
      EXPECT_GE(bound, last) << "and no less than the one before";
      last = bound;
    }
  });
}

TEST(BranchAndBoundProperty, BoundIsTrueAfterEveryBatchAndNeverFalls) {
  for_random_problems(60, [](ExplicitProblem& problem, const BranchAndBoundOptions& options) {
    double bound = 0.0, incumbent = infinity;
    std::uint64_t expanded = 0, generated = 0, told = 0;
    const auto check = [&](const SearchProgress& progress) {
      EXPECT_GE(progress.expanded, expanded);
      EXPECT_GE(progress.generated, generated);
      EXPECT_GE(progress.lower_bound, bound);
      EXPECT_LE(progress.lower_bound, problem.optimum());
      expanded = progress.expanded;
      generated = progress.generated;
      bound = progress.lower_bound;
    };
    SearchObserver<int> observer;
    observer.on_expansion = [&](const SearchProgress& progress) {
      ++told;
      check(progress);
      EXPECT_EQ(progress.incumbent_cost.value_or(infinity), incumbent);
    };
    observer.on_incumbent = [&](const Incumbent<int>& found, const SearchProgress& progress) {
      check(progress);
      EXPECT_LT(found.cost, incumbent);
      EXPECT_EQ(found.cost, progress.incumbent_cost);
      EXPECT_EQ(found.cost, problem.cost(found.state));
      incumbent = found.cost;
    };
    const auto result = branch_and_bound(problem, options, StopCondition(), {}, observer);
    EXPECT_EQ(told, problem.batches());
    EXPECT_EQ(result.counters.expanded, expanded);
    EXPECT_EQ(result.counters.generated, generated);
    EXPECT_GE(result.lower_bound, bound);
    EXPECT_EQ(result.incumbent ? result.incumbent->cost : infinity, incumbent);
  });
}

TEST(BranchAndBoundProperty, StoppedAfterAnyNumberOfNodesTheBoundIsTrue) {
  for_random_problems(60, [](ExplicitProblem& problem, BranchAndBoundOptions options) {
    ExplicitProblem again = problem;
    const auto whole = branch_and_bound(again, options, StopCondition());
    options.max_expansions = Random(again.branched()).below(whole.counters.expanded + 2);
    const auto result = branch_and_bound(problem, options, StopCondition());
    expect_true_result(problem, result);
    EXPECT_LE(result.counters.expanded, *options.max_expansions);
    if (result.reason == StopReason::max_expansions) {
      EXPECT_EQ(result.counters.expanded, *options.max_expansions);
      EXPECT_TRUE(!result.incumbent || result.incumbent->cost > options.w * result.lower_bound);
    } else {
      // The last batch may have been cut short.
      EXPECT_EQ(result.reason, whole.reason);
      if (result.incumbent) {
        EXPECT_LE(result.incumbent->cost, options.w * result.lower_bound);
      }
    }
  });
}

TEST(BranchAndBoundProperty, InterruptedInsideABatchTheBoundIsTrue) {
  std::uint64_t interrupted = 0;
  for_random_problems(100, [&](ExplicitProblem& problem, const BranchAndBoundOptions& options) {
    ExplicitProblem again = problem;
    const auto whole = branch_and_bound(again, options, StopCondition());
    if (whole.counters.expanded == 0) return;
    Random random(whole.counters.expanded);
    std::uint64_t left = random.below(whole.counters.expanded), unfinished = 0;
    StopCondition stop;
    problem.on_answer = [&](Branching<int, int>& answer) {
      if (left > 0) {
        --left;
        return;
      }
      stop.cancel();
      if (random.uniform() < 0.3) return;  // some of the others were finished
      ++unfinished;
      answer.complete = false;
      answer.children = {ExplicitProblem::poison};
      if (random.uniform() < 0.5) answer.found.reset();
    };
    const auto result = branch_and_bound(problem, options, stop);
    expect_true_result(problem, result);
    EXPECT_EQ(result.counters.expanded, problem.branched() - unfinished);
    interrupted += unfinished;
    if (result.reason == StopReason::solved) {
      EXPECT_LE(result.incumbent->cost, options.w * problem.optimum());
    } else if (result.reason == StopReason::infeasible) {
      EXPECT_EQ(problem.optimum(), infinity);
      EXPECT_EQ(unfinished, 0U);
    } else {
      EXPECT_EQ(result.reason, StopReason::cancelled);
    }
  });
  EXPECT_GT(interrupted, 1000U);
}

TEST(BranchAndBoundProperty, InitialIncumbentIsKeptUnlessASolutionIsCheaper) {
  constexpr int initial_solution = 1'000'000;
  for_random_problems(60, [](ExplicitProblem& problem, const BranchAndBoundOptions& options) {
    if (problem.optimum() == infinity) return;
    const double above = static_cast<double>(problem.random().below(3) * problem.random().below(20));
    const double cost = problem.optimum() + above;
    const auto result =
        branch_and_bound(problem, options, StopCondition(), Incumbent<int>{initial_solution, cost});
    EXPECT_EQ(result.reason, StopReason::solved);
    ASSERT_TRUE(result.incumbent);
    EXPECT_LE(result.incumbent->cost, options.w * result.lower_bound);
    EXPECT_LE(result.lower_bound, problem.optimum());
    EXPECT_EQ(result.incumbent->state == initial_solution, result.incumbent->cost == cost);
    if (result.incumbent->state != initial_solution) {
      EXPECT_EQ(result.incumbent->cost, problem.cost(result.incumbent->state));
    }
  });
}

TEST(BranchAndBoundProperty, SameSearchTwice) {
  for_random_problems(20, [](ExplicitProblem& problem, const BranchAndBoundOptions& options) {
    ExplicitProblem again = problem;
    const auto a = branch_and_bound(problem, options, StopCondition());
    const auto b = branch_and_bound(again, options, StopCondition());
    EXPECT_EQ(a.counters, b.counters);
    EXPECT_EQ(a.lower_bound, b.lower_bound);
    EXPECT_EQ(a.reason, b.reason);
    EXPECT_EQ(a.incumbent ? a.incumbent->state : -1, b.incumbent ? b.incumbent->state : -1);
    EXPECT_EQ(problem.first_bounds(), again.first_bounds());
  });
}

TEST(BranchAndBoundProperty, FractionalCostsHoldUpToRounding) {
  for_random_problems(40, [](ExplicitProblem& problem, const BranchAndBoundOptions& options) {
    problem.scale(1.0 / 3.0 + problem.random().uniform());
    const auto result = branch_and_bound(problem, options, StopCondition());
    expect_true_result(problem, result);
    EXPECT_EQ(result.incumbent.has_value(), problem.optimum() < infinity);
    if (result.incumbent) {
      EXPECT_LE(result.incumbent->cost, options.w * problem.optimum() * (1 + 1e-12));
    }
  });
}

}  // namespace
}  // namespace perch
