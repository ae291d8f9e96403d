#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "perch/candidates/candidate_set.hpp"
#include "perch/candidates/explained_bound.hpp"

namespace perch {

/// The fixed set: every (model, grid pose) refined once, alone. What is refined is an open hypothesis until
/// it is valued, which takes a rendering; bounds can do without for most. Numbers and order don't depend on
/// the executor.
class FixedCandidates {
 public:
  struct Hypothesis {
    std::size_t model = 0;
    Pose pose;              ///< after ICP; no two with the same model are equal to the bit
    float misfit = 0.0F;    ///< see Alignment: a guess at what it leaves unexplained
    Window window;          ///< that holds its rendering
    std::vector<Run> near;  ///< blocks of I that hold what it explains
  };
  using Weight = std::int64_t;

  /// Empty. Keeps references.
  FixedCandidates(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers,
                  const Executor& executor);

  /// Refines all grid poses, in the order of models and grid poses. False where the stop condition struck
  /// first.
  bool refine(const StopCondition& stop);
  /// Grid poses refined.
  std::int64_t hypotheses() const { return hypotheses_; }
  /// Different poses among them whose box reaches into the image, and the absent objects.
  std::int64_t count() const { return count_; }

  /// What is valued, and the absent object of each kind whose objects are optional.
  CandidateSet& set() { return set_; }
  const CandidateSet& set() const { return set_; }
  const std::vector<Hypothesis>& open() const { return open_; }
  /// Values hypotheses: they leave open() and enter the set, but for those of which nothing is in view.
  /// \param which places in open(), ascending. False, and nothing is valued, where the stop condition struck.
  bool value(const std::vector<std::size_t>& which, const StopCondition& stop);
  bool value_all(const StopCondition& stop);

  /// For each open hypothesis what it explains of I at most. \param point_weights >= 0, one set for all
  /// kinds or one for each. \param wanted 0 for kinds whose hypotheses are left at 0.
  std::vector<Weight> most_explained(const std::vector<std::vector<Weight>>& point_weights,
                                     const std::vector<int>& wanted) const;

 private:
  /// Sums of the weights of the blocks before each.
  std::vector<Weight> sums_of(const std::vector<Weight>& point_weights) const;

  const LocalizationProblem& problem_;
  std::vector<CandidateMaker>& makers_;
  const Executor& executor_;
  CandidateSet set_;
  std::vector<Hypothesis> open_;
  std::int64_t hypotheses_ = 0, count_ = 0;
};

}  // namespace perch
