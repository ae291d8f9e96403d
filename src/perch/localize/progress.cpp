#include "perch/localize/progress.hpp"

#include <algorithm>

namespace perch {

void ProgressLog::improved(std::optional<std::int64_t> cost, std::int64_t lower_bound) {
  const auto best = cost && now_.best_cost ? std::min(*cost, *now_.best_cost) : cost ? cost : now_.best_cost;
  // No scene is cheaper than the bound: for the best one known it is at most that scene's cost.
  const std::int64_t bound = std::max(lower_bound, now_.lower_bound);
  const bool better = best != now_.best_cost || bound != now_.lower_bound;
  now_.best_cost = best;
  now_.lower_bound = bound;
  if (better)
    trace_.push_back({watch_.seconds(), best, best, best ? std::min(bound, *best) : bound, now_.expansions});
  tell();
}

void ProgressLog::polished(std::int64_t cost, std::int64_t search_cost, std::int64_t lower_bound) {
  trace_.push_back({watch_.seconds(), cost, search_cost, lower_bound, now_.expansions});
}

}  // namespace perch
