#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "perch/core/random.hpp"
#include "perch/search/focal_mha.hpp"

namespace perch::test {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// The suboptimality factors that every search is tested at.
constexpr double factors[] = {1.0, 1.2, 3.0, 10.0};

/// A graph in full, as a search problem. Vertices are 0 .. n - 1 and the root is 0. Edges out of goals are
/// there for the reference solutions and not to be asked for.
struct ExplicitGraph {
  using State = int;

  std::vector<std::vector<Edge<int>>> edges;
  std::vector<bool> goal;
  std::uint64_t asked = 0;  ///< expansions asked for

  explicit ExplicitGraph(std::size_t vertices) : edges(vertices), goal(vertices, false) {}
  void connect(int from, int to, double cost) { edges[static_cast<std::size_t>(from)].push_back({to, cost}); }

  int root() const { return 0; }
  bool is_goal(int v) const { return goal[static_cast<std::size_t>(v)]; }
  Expansion<int> expand(int v, const StopCondition&) {
    ++asked;
    return {edges[static_cast<std::size_t>(v)], true};
  }

  /// Of the cheapest edge between the two; infinity if there is none.
  double edge_cost(int from, int to) const {
    double cheapest = infinity;
    for (const auto& edge : edges[static_cast<std::size_t>(from)])
      if (edge.state == to) cheapest = std::min(cheapest, edge.cost);
    return cheapest;
  }
};

/// The true cost left from every vertex to its nearest goal, infinity where there is none: every edge is
/// relaxed until nothing changes (Bellman and Ford), with no queue that could share a fault with the search.
inline std::vector<double> cost_left(const ExplicitGraph& graph) {
  std::vector<double> left(graph.edges.size(), infinity);
  for (std::size_t v = 0; v < left.size(); ++v)
    if (graph.goal[v]) left[v] = 0.0;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t v = 0; v < left.size(); ++v)
      for (const auto& edge : graph.edges[v]) {
        const double through = edge.cost + left[static_cast<std::size_t>(edge.state)];
        if (through < left[v]) {
          left[v] = through;
          changed = true;
        }
      }
  }
  return left;
}

/// The sum of the cheapest edges between successive states; infinity if two aren't connected.
inline double path_cost(const ExplicitGraph& graph, const std::vector<int>& path) {
  double cost = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) cost += graph.edge_cost(path[i - 1], path[i]);
  return cost;
}

enum class Shape { tree, dag, cyclic };

/// Costs are integers in 0 .. at most 30, a good part of them zero, so that sums and bounds are exact.
/// Parallel edges and loops occur; there may be no goal, or none that can be reached.
inline ExplicitGraph random_graph(Shape shape, Random& random) {
  const std::size_t vertices = 1 + random.below(40);
  const std::uint64_t dearest = 1 + random.below(30);
  const double zeros = random.uniform() < 0.3 ? 0.6 : 0.1;
  const auto cost = [&] {
    return random.uniform() < zeros ? 0.0 : static_cast<double>(random.below(dearest + 1));
  };
  const auto below = [&](std::size_t n) { return static_cast<int>(random.below(n)); };
  ExplicitGraph graph(vertices);
  if (shape == Shape::tree) {
    for (std::size_t v = 1; v < vertices; ++v) graph.connect(below(v), static_cast<int>(v), cost());
  } else {
    const std::size_t count = random.below(4 * vertices + 1);
    for (std::size_t i = 0; i < count; ++i) {
      int from = below(vertices), to = below(vertices);
      if (shape == Shape::dag) {
        if (from == to) continue;
        if (from > to) std::swap(from, to);
      }
      graph.connect(from, to, cost());
    }
  }
  const double goals = random.uniform() < 0.5 ? 0.05 : 0.2;
  for (std::size_t v = 0; v < vertices; ++v) graph.goal[v] = random.uniform() < (v == 0 ? goals / 4 : goals);
  return graph;
}

inline Heuristic<int> look_up(std::vector<double> values) {
  return [values = std::move(values)](const int& v) { return values[static_cast<std::size_t>(v)]; };
}

/// h = 0; h exact; an independent random fraction of it at each vertex, and so as inconsistent as can be.
enum class Admissible { zero, exact, fraction };

inline Heuristic<int> admissible(Admissible kind, const std::vector<double>& left, Random& random) {
  std::vector<double> values(left.size(), 0.0);
  for (std::size_t v = 0; v < left.size(); ++v) {
    if (kind == Admissible::exact) values[v] = left[v];
    if (kind != Admissible::fraction) continue;
    const double sharpness = random.uniform() < 0.3 ? 1.0 : random.uniform();
    const bool dead = left[v] == infinity;  // anything is admissible there
    values[v] = dead ? (random.uniform() < 0.5 ? infinity : random.uniform(0, 50)) : left[v] * sharpness;
  }
  return look_up(values);
}

/// Heuristics that mislead: noise, the truth reversed, huge, constant, infinite, infinite here and there; and
/// one that tells the truth.
inline std::vector<Heuristic<int>> adversaries(const std::vector<double>& left, Random& random) {
  const std::size_t n = left.size();
  std::vector<double> noise(n), reversed(n), patchy(n);
  for (std::size_t v = 0; v < n; ++v) {
    noise[v] = random.uniform(0, 100);
    reversed[v] = left[v] == infinity ? 0.0 : std::max(0.0, 1000.0 - left[v]);
    patchy[v] = random.uniform() < 0.5 ? infinity : static_cast<double>(random.below(3));
  }
  return {look_up(noise),
          look_up(reversed),
          look_up(std::vector<double>(n, 1e300)),
          look_up(std::vector<double>(n, 7.0)),
          look_up(std::vector<double>(n, infinity)),
          look_up(patchy),
          look_up(left)};
}

}  // namespace perch::test
