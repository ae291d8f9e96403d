#include "perch/candidates/candidate_floor.hpp"

namespace perch {

CandidateFloor::CandidateFloor(const ExplanationCost& cost, const Composite& others)
    : others_(others), points_(cost.charged_points()), unexplained_(others.depth.window, [&](int u, int v) {
        const std::size_t pixel = others.depth.index(u, v);
        return static_cast<int>(others.depth.depth[pixel] < no_surface && others.explained[pixel] == 0);
      }) {}

std::int64_t CandidateFloor::operator()(const Candidate& candidate) const {
  std::int64_t certain = 0;
  for (const Run& run : candidate.certain_runs) certain += run.last - run.first;
  const auto explained = static_cast<std::int64_t>(candidate.explained.count_not_in(others_.observed));
  return (*this)(explained, candidate.window) + certain;
}

std::int64_t CandidateFloor::operator()(std::int64_t most_explained, const Window& window) const {
  return points_ - others_.observed_count - most_explained + others_.unexplained - unexplained_(window);
}

}  // namespace perch
