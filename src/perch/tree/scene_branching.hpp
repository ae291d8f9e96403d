#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "perch/candidates/candidate_set.hpp"
#include "perch/candidates/lagrangian_bound.hpp"
#include "perch/search/branch_and_bound.hpp"
#include "perch/tree/shared_node_work.hpp"

namespace perch {

/// The collision-free scenes of a fixed candidate set as a branching problem, mutual occlusion included. A
/// node holds some candidates and lists what is left for the other objects; its children each take one
/// candidate for the object that promises to raise the bound most (by what it gave before: pseudo-costs).
/// Equal scenes are met once: copies of a model are taken in the order of their list.
class SceneBranching {
 public:
  /// Candidates placed, ascending numbers.
  using Solution = std::vector<CandidateId>;

  /// What the children of a node share.
  struct Family {
    std::vector<CandidateId> placed;
    Lagrangian::Weight base = 0;
    std::vector<OpenSlot> slots;
    std::size_t branching_slot = 0;  ///< the object that the children place
  };
  /// The member of a family that takes one choice of the branching slot, and of those before it none.
  struct Node {
    std::shared_ptr<const Family> family;
    std::size_t choice = 0;
    bool is_root = false;  ///< the family as a whole
    std::int64_t bound = 0;
  };

  /// Over the candidates that the bound has left; these get their renderings back, as memory and the stop
  /// condition allow. Keeps references, to all but the bound and the stop condition. \param share_after see
  /// SharedNodeWork.
  SceneBranching(const LocalizationProblem& problem, CandidateSet& set, std::vector<CandidateMaker>& makers,
                 const Executor& executor, const LagrangianBound& bound, const StopCondition& stop,
                 double share_after = SharedNodeWork::default_share_after);

  Node root() const { return {root_, 0, true, bound_}; }
  double bound(const Node& node) const { return static_cast<double>(node.bound); }
  std::vector<Branching<Node, Solution>> branch(const std::vector<Node>& nodes, double upper_bound,
                                                const StopCondition& stop);

 private:
  using Answer = Branching<Node, Solution>;

  /// How much bounds rose when an object was placed.
  struct Gain {
    double sum = 0.0;
    int times = 0;
    double mean() const { return times == 0 ? 0.0 : sum / times; }
  };

  Answer branch_root(std::int64_t upper_bound, const StopCondition& stop);
  void look_ahead(std::int64_t upper_bound, const StopCondition& stop);
  void learn(const Node& node, std::int64_t bound);
  std::size_t slot_to_branch(const std::vector<OpenSlot>& slots) const;
  std::vector<Node> children(const std::shared_ptr<const Family>& family, std::int64_t lower_bound,
                             std::int64_t upper_bound) const;

  std::shared_ptr<Family> root_;
  std::vector<Gain> gains_;  ///< by the slots of the root
  std::int64_t bound_ = 0;
  SharedNodeWork work_;
};

}  // namespace perch
