#pragma once

#include <cstdint>
#include <vector>

#include "perch/candidates/candidate_set.hpp"
#include "perch/candidates/lagrangian.hpp"

namespace perch {

/// Objects that are still to be placed, and the candidates that are left for them.
struct OpenSlot {
  struct Choice {
    CandidateId id = 0;
    Lagrangian::Weight reduced_cost = 0;  ///< what it adds to the bound
  };
  int copies = 0;
  std::size_t origin = 0;  ///< which slot of the whole problem these are copies of
  std::vector<Choice> choices;
};

/// What is known of the scenes that add one candidate for each open copy to those placed.
struct PartialBound {
  std::int64_t lower_bound = 0;
  Lagrangian::Weight base = 0;    ///< the bound, not rounded; choices add their reduced costs to it
  std::vector<OpenSlot> slots;    ///< choices left, the least reduced cost first
  std::vector<CandidateId> best;  ///< of each slot the choice that the weights favour, copies times
  bool complete = true;           ///< false where the stop condition struck: nothing above holds then
};

/// Bounds the scenes that hold what is placed, by the Lagrangian bound with exact visibility: what the
/// objects placed hide of a candidate explains nothing, what shows of it unexplained costs a point wherever
/// no candidate left can stand in front. Choices that can only be part of scenes that cost `upper_bound` are
/// dropped. The proof is in docs/algorithm.md.
/// \param placed composite of the objects placed. \param point_weights weights mu of the points of I to start
/// from, e.g. those of the whole set.
PartialBound bound_partial_scene(const LocalizationProblem& problem, const CandidateSet& set,
                                 const Composite& placed, const std::vector<OpenSlot>& slots,
                                 const std::vector<Lagrangian::Weight>& point_weights,
                                 std::int64_t upper_bound, CandidateMaker& maker, const StopCondition& stop);

}  // namespace perch
