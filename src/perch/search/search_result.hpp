#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "perch/core/stop.hpp"

namespace perch {

/// A goal and the cost of a path to it: the best known so far.
template <typename State>
struct Incumbent {
  State state;
  double cost = 0.0;
};

enum class StopReason {
  solved,          ///< the incumbent costs at most w times the lower bound
  infeasible,      ///< every state was expanded or is a dead end, and no goal is known
  time,            ///< the stop condition's deadline passed
  cancelled,       ///< the stop condition was cancelled
  max_expansions,  ///< as many expansions as were allowed
  memory           ///< as many states as were allowed
};

constexpr std::string_view name(StopReason reason) {
  switch (reason) {
    case StopReason::solved:
      return "solved";
    case StopReason::infeasible:
      return "infeasible";
    case StopReason::time:
      return "time";
    case StopReason::cancelled:
      return "cancelled";
    case StopReason::max_expansions:
      return "max_expansions";
    case StopReason::memory:
      return "memory";
  }
  return "unknown";
}

/// Why a search has to stop before it is done, if it has to. `held`: states or nodes in memory.
inline std::optional<StopReason> interruption(const StopCondition& stop, std::uint64_t expanded,
                                              std::optional<std::uint64_t> max_expansions, std::size_t held,
                                              std::size_t max_held) {
  if (stop.cancelled()) return StopReason::cancelled;
  if (stop.out_of_time()) return StopReason::time;
  if (max_expansions && expanded >= *max_expansions) return StopReason::max_expansions;
  if (held >= max_held) return StopReason::memory;
  return std::nullopt;
}

struct SearchCounters {
  std::uint64_t generated = 0;              ///< edges that expansions returned
  std::uint64_t expanded = 0;               ///< complete expansions
  std::uint64_t expanded_anchor = 0;        ///< of these, chosen by the anchor queue
  std::uint64_t expanded_inadmissible = 0;  ///< of these, chosen by an inadmissible queue
  std::uint64_t reopened = 0;    ///< states put back into OPEN by a cheaper path after they were expanded
  std::uint64_t pruned = 0;      ///< paths dropped as dead ends or as no better than the incumbent
  std::uint64_t duplicates = 0;  ///< edges to a state that was already known by a path no dearer
  std::size_t peak_open = 0;     ///< most states in OPEN at a time

  bool operator==(const SearchCounters&) const = default;
};

/// How far a search has come.
struct SearchProgress {
  std::uint64_t expanded = 0;
  std::uint64_t generated = 0;
  std::optional<double> incumbent_cost;
  double lower_bound = 0.0;  ///< proven; never decreases
};

/// Who is told of a running search. Called on the search's thread; either may be empty.
template <typename State>
struct SearchObserver {
  std::function<void(const SearchProgress&)> on_expansion;                           ///< after each expansion
  std::function<void(const Incumbent<State>&, const SearchProgress&)> on_incumbent;  ///< at each better one
};

template <typename State>
struct SearchResult {
  std::optional<Incumbent<State>> incumbent;  ///< the best goal known, whatever the reason of the stop
  double lower_bound = 0.0;  ///< no goal costs less, whatever the reason; infinity when infeasible
  StopReason reason = StopReason::infeasible;
  std::vector<State> path;  ///< root to goal, its edges sum to the cost; empty for the initial incumbent
  SearchCounters counters;
};

}  // namespace perch
