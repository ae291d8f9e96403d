#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "perch/search/focal_mha.hpp"
#include "perch/search/random_graphs_test_support.hpp"

namespace perch {
namespace {

using test::Admissible;
using test::ExplicitGraph;
using test::factors;
using test::infinity;
using test::Shape;

constexpr Shape shapes[] = {Shape::tree, Shape::dag, Shape::cyclic};
constexpr Admissible admissibles[] = {Admissible::zero, Admissible::exact, Admissible::fraction};

/// One random graph, its true costs, and heuristics for it; all from the seed.
struct Case {
  Random random;
  ExplicitGraph graph;
  std::vector<double> left;
  double optimum;
  Heuristics<int> heuristics;

  Case(std::uint64_t seed, Shape shape, Admissible kind)
      : random(seed),
        graph(test::random_graph(shape, random)),
        left(test::cost_left(graph)),
        optimum(left[0]) {
    heuristics.admissible = test::admissible(kind, left, random);
    // None, one, or all of the adversaries.
    auto all = test::adversaries(left, random);
    const std::uint64_t choice = random.below(all.size() + 2);
    if (choice < all.size())
      heuristics.inadmissible = {all[choice]};
    else if (choice == all.size())
      heuristics.inadmissible = std::move(all);
  }

  std::optional<Incumbent<int>> some_goal(double cost) const {
    for (std::size_t v = 0; v < graph.goal.size(); ++v)
      if (graph.goal[v]) return Incumbent<int>{static_cast<int>(v), cost};
    return std::nullopt;
  }
};

/// Calls check(case, w) for every shape, kind of h and w, on a graph of its own each, and names the seed of
/// what fails.
template <typename Check>
void for_random_cases(std::uint64_t seeds, const Check& check) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed)
    for (const Shape shape : shapes)
      for (const Admissible kind : admissibles)
        for (const double w : factors) {
          SCOPED_TRACE("seed " + std::to_string(seed) + ", shape " + std::to_string(static_cast<int>(shape)) +
                       ", h " + std::to_string(static_cast<int>(kind)) + ", w " + std::to_string(w));
          check(Case(seed, shape, kind), w);
          if (::testing::Test::HasFailure()) return;
        }
}

/// What holds whatever the reason of the stop, where every goal known came from the search.
void expect_true_result(const Case& c, const SearchResult<int>& result) {
  EXPECT_LE(result.lower_bound, c.optimum);
  EXPECT_EQ(result.counters.expanded,
            result.counters.expanded_anchor + result.counters.expanded_inadmissible);
  EXPECT_EQ(result.path.empty(), !result.incumbent);
  if (!result.incumbent) return;
  EXPECT_GE(result.incumbent->cost, c.optimum);
  EXPECT_LE(result.lower_bound, result.incumbent->cost);
  EXPECT_TRUE(c.graph.is_goal(result.incumbent->state));
  EXPECT_EQ(result.path.front(), 0);
  EXPECT_EQ(result.path.back(), result.incumbent->state);
  EXPECT_EQ(test::path_cost(c.graph, result.path), result.incumbent->cost);
}

TEST(FocalMhaProperty, CostsAtMostWTimesTheOptimum) {
  for_random_cases(1500, [](Case c, double w) {
    const auto result = focal_mha(c.graph, c.heuristics, {.w = w}, StopCondition());
    expect_true_result(c, result);
    EXPECT_EQ(c.graph.asked, result.counters.expanded);
    EXPECT_EQ(result.reason, c.optimum < infinity ? StopReason::solved : StopReason::infeasible);
    if (c.optimum == infinity) {
      EXPECT_FALSE(result.incumbent);
      EXPECT_EQ(result.lower_bound, infinity);
      return;
    }
    ASSERT_TRUE(result.incumbent);
    EXPECT_LE(result.incumbent->cost, w * c.optimum);
    EXPECT_LE(result.incumbent->cost, w * result.lower_bound);
    if (w == 1.0) {
      EXPECT_EQ(result.incumbent->cost, c.optimum);
    }
  });
}

TEST(FocalMhaProperty, BoundIsTrueAfterEveryExpansionAndNeverFalls) {
  for_random_cases(200, [](Case c, double w) {
    double bound = 0.0, incumbent = infinity;
    std::uint64_t expansions = 0;
    SearchObserver<int> observer;
    observer.on_expansion = [&](const SearchProgress& progress) {
      EXPECT_EQ(progress.expanded, ++expansions);
      EXPECT_LE(progress.lower_bound, c.optimum);
      EXPECT_GE(progress.lower_bound, bound);
      EXPECT_EQ(progress.incumbent_cost.value_or(infinity), incumbent);
      bound = progress.lower_bound;
    };
    observer.on_incumbent = [&](const Incumbent<int>& goal, const SearchProgress& progress) {
      EXPECT_LT(goal.cost, incumbent);
      EXPECT_GE(goal.cost, c.optimum);
      EXPECT_EQ(goal.cost, progress.incumbent_cost);
      EXPECT_LE(progress.lower_bound, c.optimum);
      incumbent = goal.cost;
    };
    const auto result = focal_mha(c.graph, c.heuristics, {.w = w}, StopCondition(), {}, observer);
    EXPECT_EQ(result.counters.expanded, expansions);
    EXPECT_EQ(result.incumbent ? result.incumbent->cost : infinity, incumbent);
  });
}

TEST(FocalMhaProperty, StoppedAfterAnyNumberOfExpansionsTheBoundIsTrue) {
  for_random_cases(200, [](Case c, double w) {
    const auto whole = focal_mha(c.graph, c.heuristics, {.w = w}, StopCondition());
    const std::uint64_t most = c.random.below(whole.counters.expanded + 2);
    const auto result = focal_mha(c.graph, c.heuristics, {.w = w, .max_expansions = most}, StopCondition());
    expect_true_result(c, result);
    EXPECT_LE(result.lower_bound, whole.lower_bound);
    if (most < whole.counters.expanded) {
      EXPECT_EQ(result.reason, StopReason::max_expansions);
      EXPECT_EQ(result.counters.expanded, most);
    } else {
      EXPECT_EQ(result.reason, whole.reason);
      EXPECT_EQ(result.counters, whole.counters);
    }
  });
}

/// Cancels inside one expansion, of which it then returns some of the edges only. The others are taken out of
/// the graph, so that it shows what the search has seen.
struct Interrupted {
  using State = int;
  ExplicitGraph& graph;
  StopCondition& condition;
  Random& random;
  std::uint64_t at;

  int root() const { return graph.root(); }
  bool is_goal(int v) const { return graph.is_goal(v); }
  Expansion<int> expand(int v, const StopCondition& stop) {
    Expansion<int> expansion = graph.expand(v, stop);
    if (graph.asked < at) return expansion;
    condition.cancel();
    std::erase_if(expansion.edges, [this](const auto&) { return random.uniform() < 0.5; });
    expansion.complete = false;
    graph.edges[static_cast<std::size_t>(v)] = expansion.edges;
    return expansion;
  }
};

TEST(FocalMhaProperty, InterruptedInsideAnExpansionTheBoundIsTrue) {
  for_random_cases(200, [](Case c, double w) {
    const auto whole = focal_mha(c.graph, c.heuristics, {.w = w}, StopCondition());
    if (whole.counters.expanded == 0) return;
    const std::uint64_t at = 1 + c.random.below(whole.counters.expanded);
    c.graph.asked = 0;
    StopCondition stop;
    Interrupted problem{c.graph, stop, c.random, at};
    const auto result = focal_mha(problem, c.heuristics, {.w = w}, stop);
    expect_true_result(c, result);
    EXPECT_EQ(result.counters.expanded, at - 1);
    if (result.reason == StopReason::solved) {
      EXPECT_LE(result.incumbent->cost, w * c.optimum);
    } else {
      EXPECT_EQ(result.reason, StopReason::cancelled);
    }
  });
}

TEST(FocalMhaProperty, InitialIncumbentIsKeptUnlessAPathIsCheaper) {
  for_random_cases(200, [](Case c, double w) {
    if (c.optimum == infinity) return;
    const double cost = c.optimum + static_cast<double>(c.random.below(3) * c.random.below(20));
    const auto initial = c.some_goal(cost);
    const auto without = focal_mha(c.graph, c.heuristics, {.w = w}, StopCondition());
    const auto result = focal_mha(c.graph, c.heuristics, {.w = w}, StopCondition(), initial);
    EXPECT_EQ(result.reason, StopReason::solved);
    ASSERT_TRUE(result.incumbent);
    EXPECT_LE(result.incumbent->cost, cost);
    EXPECT_LE(result.incumbent->cost, w * result.lower_bound);
    EXPECT_LE(result.lower_bound, c.optimum);
    EXPECT_GE(result.incumbent->cost, c.optimum);
    EXPECT_EQ(result.path.empty(), result.incumbent->cost == cost);
    if (!result.path.empty()) {
      EXPECT_EQ(test::path_cost(c.graph, result.path), result.incumbent->cost);
    }
    if (c.heuristics.inadmissible.empty()) {
      EXPECT_LE(result.counters.expanded, without.counters.expanded);
    }
  });
}

// The search that stops at w, and then goes on as the same search until the optimum is proven.
TEST(FocalMhaProperty, AnytimeGoesOnUntilTheOptimumIsProven) {
  std::uint64_t improved = 0;
  for_random_cases(200, [&](Case c, double w) {
    std::vector<std::pair<std::uint64_t, double>> found;
    SearchObserver<int> observer;
    observer.on_incumbent = [&](const Incumbent<int>& goal, const SearchProgress& progress) {
      found.emplace_back(progress.expanded, goal.cost);
    };
    const auto first = focal_mha(c.graph, c.heuristics, {.w = w}, StopCondition(), {}, observer);
    const auto until_w = std::exchange(found, {});
    const auto result =
        focal_mha(c.graph, c.heuristics, {.w = w, .anytime = true}, StopCondition(), {}, observer);
    expect_true_result(c, result);
    EXPECT_EQ(result.reason, first.reason);
    EXPECT_EQ(result.incumbent ? result.incumbent->cost : infinity, c.optimum);
    EXPECT_EQ(result.lower_bound, c.optimum);
    EXPECT_GE(result.counters.expanded, first.counters.expanded);
    ASSERT_GE(found.size(), until_w.size());
    EXPECT_TRUE(std::equal(until_w.begin(), until_w.end(), found.begin()));
    improved += found.size() > until_w.size();
  });
  EXPECT_GT(improved, 50U);
}

TEST(FocalMhaProperty, SameSearchTwice) {
  for_random_cases(20, [](Case c, double w) {
    const auto a = focal_mha(c.graph, c.heuristics, {.w = w}, StopCondition());
    const auto b = focal_mha(c.graph, c.heuristics, {.w = w}, StopCondition());
    EXPECT_EQ(a.counters, b.counters);
    EXPECT_EQ(a.path, b.path);
    EXPECT_EQ(a.lower_bound, b.lower_bound);
    EXPECT_EQ(a.reason, b.reason);
  });
}

TEST(FocalMhaProperty, AsksAHeuristicAtMostOnceAState) {
  for_random_cases(20, [](Case c, double w) {
    const std::size_t n = c.graph.edges.size();
    std::vector<int> admissible(n, 0), inadmissible(n, 0);
    const auto counting = [&c](std::vector<int>& count, const Heuristic<int>& heuristic) {
      return [&c, &count, heuristic](const int& v) {
        EXPECT_FALSE(c.graph.is_goal(v));
        EXPECT_EQ(++count[static_cast<std::size_t>(v)], 1);
        return heuristic(v);
      };
    };
    Heuristics<int> heuristics;
    heuristics.admissible = counting(admissible, c.heuristics.admissible);
    if (!c.heuristics.inadmissible.empty())
      heuristics.inadmissible = {counting(inadmissible, c.heuristics.inadmissible[0])};
    focal_mha(c.graph, heuristics, {.w = w}, StopCondition());
  });
}

TEST(FocalMhaProperty, FractionalCostsHoldUpToRounding) {
  for_random_cases(30, [](Case c, double w) {
    const double scale = 1.0 / 3.0 + c.random.uniform();
    for (auto& edges : c.graph.edges)
      for (auto& edge : edges) edge.cost *= scale;
    const double optimum = test::cost_left(c.graph)[0];
    Heuristics<int> heuristics = c.heuristics;
    heuristics.admissible = [&](const int& v) { return scale * c.heuristics.admissible(v); };
    const auto result = focal_mha(c.graph, heuristics, {.w = w}, StopCondition());
    if (optimum == infinity) {
      EXPECT_EQ(result.reason, StopReason::infeasible);
      return;
    }
    ASSERT_TRUE(result.incumbent);
    EXPECT_LE(result.incumbent->cost, w * optimum * (1 + 1e-12));
    EXPECT_LE(result.lower_bound, optimum * (1 + 1e-12));
  });
}

}  // namespace
}  // namespace perch
