#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "perch/candidates/candidate_set.hpp"

namespace perch {

/// A node of the Monotone Scene Generation Tree: which candidates are placed, whatever the order. Two that
/// place the same candidates are one state, and copies of a kind are interchangeable.
struct SceneState {
  std::vector<CandidateId> placed;  ///< ascending
  /// g: what the placed objects are sure to cost in every scene below; the flat J where all are placed.
  std::int64_t cost = 0;
  /// f = g + h: no scene below costs less. At least `cost`.
  std::int64_t bound = 0;

  friend bool operator==(const SceneState& a, const SceneState& b) { return a.placed == b.placed; }
};

}  // namespace perch

template <>
struct std::hash<perch::SceneState> {
  std::size_t operator()(const perch::SceneState& state) const noexcept {
    std::uint64_t h = 0xcbf29ce484222325ULL;  // FNV-1a over the numbers
    for (const perch::CandidateId id : state.placed) h = (h ^ id) * 0x100000001b3ULL;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
};
