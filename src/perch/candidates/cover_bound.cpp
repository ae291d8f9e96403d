#include "perch/candidates/cover_bound.hpp"

#include <algorithm>

namespace perch {

CoverBound::CoverBound(const CandidateSet& set, std::size_t kinds) : set_(set) {
  for (std::size_t kind = 0; kind < kinds; ++kind) {
    by_count_.push_back(set.of_kind(kind));
    std::stable_sort(by_count_.back().begin(), by_count_.back().end(), [&](CandidateId a, CandidateId b) {
      return set[a].explained_count > set[b].explained_count;
    });
  }
}

std::int64_t CoverBound::operator()(const PointSet& covered, std::int64_t points,
                                    const std::vector<int>& remaining) const {
  std::int64_t unexplained = points - static_cast<std::int64_t>(covered.count());
  for (std::size_t kind = 0; kind < remaining.size(); ++kind) {
    if (remaining[kind] == 0) continue;
    std::int64_t most = 0;
    for (const CandidateId id : by_count_[kind]) {
      if (set_[id].explained_count <= most) break;  // and so do all after it
      most = std::max(most, static_cast<std::int64_t>(set_[id].explained.count_not_in(covered)));
    }
    unexplained -= most * remaining[kind];
  }
  return std::max<std::int64_t>(0, unexplained);
}

}  // namespace perch
