#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "perch/candidates/candidate_set.hpp"
#include "perch/candidates/partial_bound.hpp"
#include "perch/search/search_result.hpp"

namespace perch {

/// A node of the branching over scenes, to be worked on.
struct OpenNode {
  std::vector<CandidateId> placed;  ///< the choices below collide with none of them but perhaps the last
  std::vector<OpenSlot> slots;      ///< what is left for the other objects; only ids and their order count
};

/// What working on a node gave.
struct NodeFinding {
  bool complete = false;   ///< false where the stop condition struck: only `found` holds then
  std::int64_t bound = 0;  ///< no scene of the node costs less, or none less than the upper bound
  std::optional<Incumbent<std::vector<CandidateId>>> found;  ///< the best scene met, ascending numbers
  /// As PartialBound has them, for the children; empty where the node has none.
  Lagrangian::Weight base = 0;
  std::vector<OpenSlot> slots;
};

/// Works on nodes, each by itself: bounds the scenes that hold what is placed and tries some of them.
class NodeWork {
 public:
  /// Keeps references. \param point_weights as for bound_partial_scene.
  NodeWork(const LocalizationProblem& problem, const CandidateSet& set,
           std::vector<Lagrangian::Weight> point_weights)
      : problem_(problem), set_(set), point_weights_(std::move(point_weights)) {}

  /// May be called by several threads, each with a maker of its own. \param upper_bound scenes that cost as
  /// much are of no use.
  NodeFinding work(const OpenNode& node, std::int64_t upper_bound, CandidateMaker& maker,
                   const StopCondition& stop) const;

  const std::vector<Lagrangian::Weight>& point_weights() const { return point_weights_; }

 private:
  std::vector<OpenSlot> slots_beside_last(const OpenNode& node) const;
  void complete(const Composite& composite, const std::vector<CandidateId>& placed,
                const std::vector<OpenSlot>& last, std::int64_t upper_bound, CandidateMaker& maker,
                const StopCondition& stop, NodeFinding& finding) const;
  void try_scene(Composite composite, std::vector<CandidateId> placed, const std::vector<CandidateId>& more,
                 std::int64_t upper_bound, CandidateMaker& maker, NodeFinding& finding) const;

  const LocalizationProblem& problem_;
  const CandidateSet& set_;
  std::vector<Lagrangian::Weight> point_weights_;
};

}  // namespace perch
