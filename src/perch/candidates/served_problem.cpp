#include "perch/candidates/served_problem.hpp"

#include <stdexcept>

namespace perch {

const LocalizationProblem& ServedProblem::problem() const {
  if (!problem_) throw std::runtime_error("there is no problem to serve");
  return *problem_;
}

void ServedProblem::write_effort(ByteWriter& to) {
  Effort effort;
  for (const CandidateMaker& maker : makers_) effort += maker.effort();
  forget_effort();
  to.value(effort);
}

void ServedProblem::forget_effort() {
  for (CandidateMaker& maker : makers_) maker.set_effort({});
}

Effort read_effort(ByteReader& from) {
  return from.value<Effort>();
}

}  // namespace perch
