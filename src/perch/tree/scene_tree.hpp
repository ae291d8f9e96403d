#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "perch/candidates/candidate_set.hpp"
#include "perch/candidates/cover_bound.hpp"
#include "perch/candidates/lagrangian_bound.hpp"
#include "perch/candidates/priors.hpp"
#include "perch/search/search_problem.hpp"
#include "perch/tree/child_valuation.hpp"
#include "perch/tree/monotone.hpp"
#include "perch/tree/scene_state.hpp"

namespace perch {

/// The Monotone Scene Generation Tree (paper, section IV): the root is the empty scene, a child adds one
/// object that does not hide what its parent renders, goals hold all K objects.
///
/// The cost of an edge is the rise of `SceneState::cost`, which depends on the state alone, so that all
/// orders of a scene cost the same and edges along a path to a goal add up to its flat J:
///
///     g(s) = max(0, C_r(s) - (K - j) n) + |{p in I, in V_s : no placed candidate alone explains p}|, j < K
///     g(s) = J(s), j = K
///
/// where j = |s|. C_r counts the points of R_j that are unexplained at every depth in [z - (K - j) t, z] on
/// their rays: whatever the K - j objects to come may do within the monotone tolerance (n, t), at least that
/// many stay. V_s holds the points of I so deep in a placed solid that no object beside it can explain them.
/// Both only grow from parent to child, and bound the two terms of J from below (docs/algorithm.md has the
/// proofs).
class SceneTree {
 public:
  using State = SceneState;

  /// Over a fixed set: a child adds one of its candidates. Keeps references.
  static SceneTree fixed(const LocalizationProblem& problem, CandidateSet& set,
                         std::vector<CandidateMaker>& makers, const Executor& executor,
                         const MonotoneSettings& settings);
  /// ICP in context: a child adds an object refined from a grid pose with its parent's scene in front, or
  /// leaves out an object that may be absent. Candidates made are added to the set.
  static SceneTree in_context(const LocalizationProblem& problem, CandidateSet& set,
                              std::vector<CandidateMaker>& makers, const Executor& executor,
                              const MonotoneSettings& settings);

  /// Over a fixed set: adds the Lagrangian bound to the tree's own, and leaves out children for which it
  /// reaches `upper_bound`, the cost of a known scene. \param lower_bound what the Lagrangian bound says of
  /// all scenes: no less than the base of the reduced costs.
  void use(const ReducedCosts& reduced_costs, std::int64_t lower_bound, std::int64_t upper_bound);

  /// Over a fixed set: values states by what is placed alone, h = 0 as in the paper.
  void forget_cover_bound() { cover_bound_.reset(); }

  State root() const;
  bool is_goal(const State& state) const { return state.placed.size() == problem_.object_count(); }
  Expansion<State> expand(const State& state, const StopCondition& stop);

  /// In context: the scene that the priors lead to, the nearest object to the camera first, each made from
  /// the grid pose nearest to its prior; optional objects without a prior are left out. Empty where that is
  /// no path of the tree.
  std::optional<State> guided_by(const std::vector<PriorPose>& priors);

  /// The state that places these candidates, valued as the tree values it. Not checked against the tree's
  /// conditions.
  State state_of(std::vector<CandidateId> placed) const;
  /// True if the tree holds a path to this scene: collision-free and monotone in some order.
  bool contains(const std::vector<CandidateId>& placed) const;

  /// (model, grid pose, parent) triples valued in context, each once; 0 over a fixed set, whose candidates
  /// are valued once, when the set is made.
  std::int64_t hypotheses() const { return hypotheses_; }
  /// Of these, the ones that the parent did not change: taken from when they stood alone, without ICP.
  std::int64_t reused() const { return reused_; }
  /// In context: refines and values every hypothesis anew, as a check.
  void forget_lone_hypotheses() { valuation_.forget_lone(); }
  const CandidateSet& candidates() const { return set_; }

 private:
  /// What all children of a state share.
  struct Parent {
    ParentScene scene;
    std::vector<int> remaining;           ///< copies left of each kind
    ReducedCosts::Weight lagrangian = 0;  ///< the Lagrangian bound with what is placed
  };
  /// What is known of a hypothesis of the tree in context as it is alone.
  struct Lone {
    bool made = false;
    std::optional<CandidateId> id;  ///< where it was the candidate of a child
  };
  struct Child {
    std::optional<Candidate> made;  ///< in context: the candidate, where not yet in the set
    CandidateId id = 0;
    std::int64_t cost = 0, bound = 0;
    bool valid = false;
    bool as_alone = false;
  };
  struct Hypothesis {
    std::size_t model;
    CandidateId id;     ///< over a fixed set, and of objects left out
    std::int64_t grid;  ///< in context; -1 for an object left out
  };

  SceneTree(const LocalizationProblem& problem, CandidateSet& set, std::vector<CandidateMaker>& makers,
            const Executor& executor, const MonotoneSettings& settings, bool in_context);

  Parent make_parent(const State& state) const;
  std::vector<Hypothesis> hypotheses_of(const Parent& parent) const;
  std::int64_t lagrangian_with(const Parent& parent, CandidateId id) const;
  void value_fixed(const Parent& parent, CandidateId id, CandidateMaker& maker, Child& child) const;
  bool value_in_context(const Parent& parent, const std::vector<Hypothesis>& hypotheses,
                        const StopCondition& stop, std::vector<Child>& children);
  Lone& lone(const Hypothesis& hypothesis) {
    return lone_[hypothesis.model][static_cast<std::size_t>(hypothesis.grid)];
  }
  bool add_volumes(const StopCondition& stop);
  std::optional<State> add_child(const State& state, const Hypothesis& hypothesis, Child child);
  std::vector<Hypothesis> near(const PriorPose& prior) const;
  std::optional<State> best_child(const State& state, const std::vector<Hypothesis>& hypotheses);

  const LocalizationProblem& problem_;
  CandidateSet& set_;
  std::vector<CandidateMaker>& makers_;
  const Executor& executor_;
  MonotoneSettings settings_;
  std::optional<CoverBound> cover_bound_;  ///< over a fixed set
  bool in_context_;
  ReducedCosts reduced_costs_;
  std::optional<std::int64_t> upper_bound_;  ///< set where the reduced costs are used
  std::int64_t lower_bound_ = 0;
  std::size_t with_volumes_ = 0;  ///< candidates of the set whose volumes are filled in
  std::int64_t hypotheses_ = 0;
  /// Of these, valued for the priors, by what was placed: the expansion of that state has them too.
  std::map<std::vector<CandidateId>, std::int64_t> guided_;
  ChildValuation valuation_;
  std::vector<std::vector<Lone>> lone_;  ///< in context, of each body and grid pose
  std::int64_t reused_ = 0;
};

}  // namespace perch
