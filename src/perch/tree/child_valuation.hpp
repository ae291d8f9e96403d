#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "perch/candidates/candidate_maker.hpp"
#include "perch/tree/monotone.hpp"

namespace perch {

/// What all children of a state of the scene generation tree share.
struct ParentScene {
  std::vector<const Candidate*> placed;
  Composite composite;
  PointSet covered;                   ///< points of I that some placed candidate alone explains
  PointSet enclosed;                  ///< V_s
  std::vector<std::uint8_t> charged;  ///< pixels of the composite that count in C_r of a child
  std::int64_t charged_count = 0;
  int left_after = 0;  ///< objects that remain to be placed after a child
};

/// Makes and values the children of states: see SceneTree for what they cost. Keeps hypotheses that a parent
/// did not change, to use them again.
class ChildValuation {
 public:
  /// Keeps a reference. Throws InvalidSetting. \param in_context there is memory for what make() keeps.
  ChildValuation(const LocalizationProblem& problem, const MonotoneSettings& settings, bool in_context);

  /// \param placed with their volumes; kept by address.
  ParentScene parent(std::vector<const Candidate*> placed, CandidateMaker& maker) const;

  struct Value {
    bool valid = false;         ///< monotone, and collides with nothing placed
    std::int64_t cost = 0;      ///< g
    std::int64_t rendered = 0;  ///< of it, before the last object: what rendered points are sure to cost
    PointSet covered;           ///< and what the placed candidates explain with it
  };
  /// Of the child that adds a candidate with its volumes.
  Value value(const ParentScene& parent, const Candidate& candidate, CandidateMaker& maker) const;

  struct InContext {
    std::optional<Candidate> candidate;  ///< with its volumes; empty where nothing of it is in view
    bool as_alone = false;  ///< the scene in front changed nothing: it is what it is alone, to the bit
  };
  /// The candidate that grows from a grid pose with a scene in front. Lazily: where the scene hides nothing
  /// that making it looks at, it is what it is alone, and so is the value of its edge but for the
  /// composition. Only the others are refined and rendered again. May be called for different grid poses at
  /// once. \param known it has been made before, as it is alone, here or in another process: where the scene
  /// changes nothing now, only the rendering that its value needs is work.
  InContext make(std::size_t model, std::int64_t grid_pose, bool known, const DepthPatch& in_front,
                 CandidateMaker& maker);
  /// Makes all anew from now on, as a check.
  void forget_lone() { lazy_ = false; }

 private:
  /// A hypothesis as it is without a parent scene.
  struct Lone {
    std::optional<Candidate> candidate;
    Sight seen;
    bool made = false;
  };
  std::int64_t charged_with(const ParentScene& parent, const DepthPatch& patch) const;

  const LocalizationProblem& problem_;
  MonotoneSettings settings_;
  bool lazy_ = true;
  std::vector<std::vector<Lone>> lone_;  ///< of each body and grid pose
};

}  // namespace perch
