#include "perch/localize/candidate_floor.hpp"

namespace perch {

CandidateFloor::CandidateFloor(const ExplanationCost& cost, const Composite& others)
    : others_(others),
      points_(static_cast<std::int64_t>(cost.observation().size())),
      window_(others.depth.window),
      pitch_(static_cast<std::size_t>(window_.width()) + 1),
      sums_(pitch_ * (static_cast<std::size_t>(window_.height()) + 1), 0) {
  for (int v = window_.v0; v < window_.v1; ++v)
    for (int u = window_.u0; u < window_.u1; ++u) {
      const std::size_t pixel = others.depth.index(u, v);
      const bool unexplained = others.depth.depth[pixel] < no_surface && others.explained[pixel] == 0;
      sums_[at(u + 1, v + 1)] =
          sums_[at(u, v + 1)] + sums_[at(u + 1, v)] - sums_[at(u, v)] + (unexplained ? 1 : 0);
    }
}

std::int64_t CandidateFloor::operator()(const Candidate& candidate) const {
  std::int64_t certain = 0;
  for (const Run& run : candidate.certain_runs) certain += run.last - run.first;
  const std::int64_t explained =
      others_.observed_count + static_cast<std::int64_t>(candidate.explained.count_not_in(others_.observed));
  return points_ - explained + certain + others_.unexplained - unexplained_in(candidate.window);
}

std::int64_t CandidateFloor::unexplained_in(const Window& window) const {
  const Window w = intersection(window, window_);
  if (w.empty()) return 0;
  return sums_[at(w.u1, w.v1)] - sums_[at(w.u0, w.v1)] - sums_[at(w.u1, w.v0)] + sums_[at(w.u0, w.v0)];
}

}  // namespace perch
