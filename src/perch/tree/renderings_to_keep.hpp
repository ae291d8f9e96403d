#pragma once

#include <cstddef>
#include <vector>

#include "perch/candidates/candidate_set.hpp"

namespace perch {

/// Candidates whose renderings are to be kept, as memory allows.
class RenderingsToKeep {
 public:
  void add(CandidateId id, const Window& window) {
    bytes_ +=
        static_cast<std::size_t>(window.width()) * static_cast<std::size_t>(window.height()) * sizeof(float);
    if (bytes_ <= most_bytes) ids_.push_back(id);
  }
  /// However much memory it takes.
  void add_always(CandidateId id) { ids_.push_back(id); }

  const std::vector<CandidateId>& ids() const { return ids_; }

 private:
  static constexpr std::size_t most_bytes = 256U << 20U;

  std::size_t bytes_ = 0;
  std::vector<CandidateId> ids_;
};

}  // namespace perch
