#pragma once

#include <cstdint>
#include <vector>

#include "perch/candidates/candidate.hpp"
#include "perch/core/summed_area.hpp"
#include "perch/cost/explanation_cost.hpp"

namespace perch {

/// The least that a scene can cost once a candidate is added to a composite of other objects: quick, and
/// never above its J.
///
/// Proof. A point of I that the scene explains lies within delta of a point of R. That is one of the
/// candidate's, so the point of I is in E(c), or one of the others', which then is in their composite too,
/// since the candidate only hides some of it. So
/// J_observed >= |I| - |E(c) or explained by the composite|. A pixel of B(c) shows the candidate or what
/// hides it, unexplained either way; a pixel outside the candidate's window shows what the composite shows.
/// So J_rendered >= |B(c)| + (unexplained pixels of the composite outside the window).
class CandidateFloor {
 public:
  /// Keeps a reference to `others`.
  CandidateFloor(const ExplanationCost& cost, const Composite& others);

  std::int64_t operator()(const Candidate& candidate) const;
  /// The same for one that is not valued. \param most_explained of the points that the others don't explain,
  /// at most. \param window that holds its rendering.
  std::int64_t operator()(std::int64_t most_explained, const Window& window) const;

 private:
  const Composite& others_;
  std::int64_t points_;     ///< of I that cost something
  SummedArea unexplained_;  ///< pixels of the composite
};

}  // namespace perch
