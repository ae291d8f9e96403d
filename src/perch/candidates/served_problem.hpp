#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "perch/candidates/candidate_maker.hpp"
#include "perch/core/bytes.hpp"

namespace perch {

/// The problem that a process serves, which its services share; makers as make_makers gives them.
class ServedProblem {
 public:
  void set(std::unique_ptr<LocalizationProblem> problem, std::vector<CandidateMaker> makers) {
    ++version_;
    makers_ = std::move(makers);
    problem_ = std::move(problem);
  }
  void clear() { set(nullptr, {}); }

  /// Throws std::runtime_error where there is none.
  const LocalizationProblem& problem() const;
  CandidateMaker& maker(std::size_t worker) { return makers_[worker]; }
  /// Another for each problem that is set.
  std::uint64_t version() const { return version_; }

  /// Writes what the makers did since the last time; read_effort reads it.
  void write_effort(ByteWriter& to);
  /// What the makers did since the last time doesn't count.
  void forget_effort();

 private:
  std::uint64_t version_ = 0;
  std::unique_ptr<LocalizationProblem> problem_;
  std::vector<CandidateMaker> makers_;  // of the problem
};

Effort read_effort(ByteReader& from);

}  // namespace perch
