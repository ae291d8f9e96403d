#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "perch/candidates/candidate.hpp"
#include "perch/candidates/candidate_maker.hpp"
#include "perch/candidates/problem.hpp"

namespace perch {

using CandidateId = std::uint32_t;

/// Candidates by number. Two with the same model and the same refined pose, to the bit, are one. A kind
/// whose objects are optional has one more, the absent object, which every absent copy takes.
class CandidateSet {
 public:
  CandidateSet() = default;
  explicit CandidateSet(const LocalizationProblem& problem);

  CandidateId add(Candidate candidate);
  std::size_t size() const { return candidates_.size(); }
  const Candidate& operator[](CandidateId id) const { return candidates_[id]; }
  Candidate& operator[](CandidateId id) { return candidates_[id]; }
  /// The kind of the object that a candidate places.
  std::size_t kind(CandidateId id) const { return kind_of_[candidates_[id].model]; }
  /// The candidates of a kind, by number: of all its bodies.
  const std::vector<CandidateId>& of_kind(std::size_t kind) const { return of_kind_[kind]; }
  /// Takes the candidates for which `keep` is false out of of_kind(); they keep their numbers.
  void restrict_to(const std::vector<char>& keep);
  /// Memory held by sets of points and patches, bytes.
  std::size_t bytes() const;

 private:
  std::deque<Candidate> candidates_;
  std::vector<std::size_t> kind_of_;  ///< of each model
  std::vector<std::vector<CandidateId>> of_kind_;
  std::map<std::tuple<std::size_t, bool, double, double, double>, CandidateId> numbers_;
};

/// One maker for each worker of an executor.
std::vector<CandidateMaker> make_makers(const LocalizationProblem& problem, const Executor& executor);

}  // namespace perch
