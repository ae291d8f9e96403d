#pragma once

#include <concepts>
#include <cstddef>
#include <functional>
#include <vector>

#include "perch/core/stop.hpp"

namespace perch {

/// A successor and what the step to it costs: finite and >= 0. Zero is a cost like any other.
template <typename State>
struct Edge {
  State state;
  double cost = 0.0;
};

/// The successors of one state. `complete` is false only where the stop condition struck inside the
/// expansion: the edges listed are then true edges, but some may be missing.
template <typename State>
struct Expansion {
  std::vector<Edge<State>> edges;
  bool complete = true;
};

/// What a best-first search over an implicit graph asks of a problem.
///
/// `root()` is where paths start. `expand(state, stop)` lists every edge out of a state that is no goal, in
/// an order that depends on the state alone (or gives up, see Expansion). States that compare equal are one
/// state, by whatever path they were reached. Edges out of goals are never asked for: with costs >= 0 no goal
/// behind a goal is cheaper.
template <typename P>
concept SearchProblem = std::equality_comparable<typename P::State> && std::copyable<typename P::State> &&
    requires(P& problem, const typename P::State& state, const StopCondition& stop) {
  { std::hash<typename P::State>{}(state) } -> std::convertible_to<std::size_t>;
  { problem.root() } -> std::convertible_to<typename P::State>;
  { problem.is_goal(state) } -> std::convertible_to<bool>;
  { problem.expand(state, stop) } -> std::same_as<Expansion<typename P::State>>;
};

}  // namespace perch
