#pragma once

#include <cstdint>
#include <vector>

#include "perch/candidates/candidate_set.hpp"

namespace perch {

/// The simple admissible bound: an object explains no more points of I than its unoccluded rendering does,
/// since occlusion only removes rendered points. So of the points that nothing placed so far could explain,
/// all but the sum of the best that each remaining object could add stay unexplained.
class CoverBound {
 public:
  /// Over the candidates of a fixed set; keeps a reference.
  CoverBound(const CandidateSet& set, std::size_t kinds);

  /// Points of I that stay unexplained in every scene that adds the remaining copies to a scene whose
  /// candidates alone explain `covered`. Never falls when a candidate is added to `covered` and its copy
  /// taken from `remaining`. \param points |I|. \param remaining copies left of each kind.
  std::int64_t operator()(const PointSet& covered, std::int64_t points,
                          const std::vector<int>& remaining) const;

 private:
  const CandidateSet& set_;
  std::vector<std::vector<CandidateId>> by_count_;  ///< of each kind, those that explain most first
};

}  // namespace perch
