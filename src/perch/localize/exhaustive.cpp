#include "perch/localize/exhaustive.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "perch/core/error.hpp"

namespace perch {
namespace {

constexpr double most_arrangements = 1e7;

/// Ways to choose `copies` out of n, repeats allowed, order ignored.
double multisets(std::size_t n, int copies) {
  double ways = 1.0;
  for (int i = 0; i < copies; ++i) ways *= static_cast<double>(n + static_cast<std::size_t>(i)) / (i + 1);
  return ways;
}

/// All scenes that begin with one given candidate.
class Enumerator {
 public:
  Enumerator(const LocalizationProblem& problem, const CandidateSet& set, CandidateMaker& maker,
             const MonotoneSettings* monotone, const StopCondition& stop)
      : problem_(problem), set_(set), maker_(maker), monotone_(monotone), stop_(stop) {
    for (std::size_t kind = 0; kind < problem.kinds(); ++kind)
      for (int copy = 0; copy < problem.copies()[kind]; ++copy) kinds_.push_back(kind);
  }

  Enumeration run(std::size_t first) {
    place(first, problem_.cost().empty());
    return result_;
  }

 private:
  /// Places the next object at the i-th candidate of its kind, and then all that follow.
  void place(std::size_t i, const Composite& before) {
    if (stop_()) result_.complete = false;
    if (!result_.complete) return;
    const std::size_t kind = kinds_[placed_.size()];
    const CandidateId id = set_.of_kind(kind)[i];
    if (std::any_of(placed_.begin(), placed_.end(),
                    [&](CandidateId other) { return problem_.collide(set_[id], set_[other]); }))
      return;
    Composite composite = before;
    maker_.add(composite, set_[id]);
    placed_.push_back(id);
    if (placed_.size() == kinds_.size()) {
      value(composite);
    } else {
      const bool repeat = kinds_[placed_.size()] == kind;
      const std::size_t choices = set_.of_kind(kinds_[placed_.size()]).size();
      for (std::size_t next = repeat ? i : 0; next < choices; ++next) place(next, composite);
    }
    placed_.pop_back();
  }

  void value(const Composite& composite) {
    const std::int64_t cost = problem_.cost().counts(composite).total();
    if (monotone_ != nullptr && !is_monotone()) return;
    ++result_.scenes;
    if (result_.best && result_.best->cost <= cost) return;
    result_.best = CandidateScene{placed_, cost};
    std::sort(result_.best->candidates.begin(), result_.best->candidates.end());
  }

  bool is_monotone() const {
    std::vector<DepthPatch> patches;
    for (const CandidateId id : placed_) patches.push_back(maker_.patch(set_[id]));
    return monotone_order_exists(problem_.cost(), patches, *monotone_);
  }

  const LocalizationProblem& problem_;
  const CandidateSet& set_;
  CandidateMaker& maker_;
  const MonotoneSettings* monotone_;
  const StopCondition& stop_;
  std::vector<std::size_t> kinds_;  ///< of the objects, ascending
  std::vector<CandidateId> placed_;
  Enumeration result_;
};

}  // namespace

Enumeration enumerate_scenes(const LocalizationProblem& problem, const CandidateSet& set,
                             std::vector<CandidateMaker>& makers, const Executor& executor,
                             const MonotoneSettings* monotone, const StopCondition& stop) {
  double ways = 1.0;
  std::size_t first_kind = problem.kinds();
  for (std::size_t kind = 0; kind < problem.kinds(); ++kind) {
    if (problem.copies()[kind] == 0) continue;
    first_kind = std::min(first_kind, kind);
    ways *= multisets(set.of_kind(kind).size(), problem.copies()[kind]);
  }
  if (ways > most_arrangements)
    throw InputError(
        fmt::format("there are {:.3g} ways to place the objects, more than {:.0f} can be enumerated; use "
                    "larger --resolution or --yaw-resolution-deg, a smaller workspace, or a search",
                    ways, most_arrangements));
  std::vector<Enumeration> parts(set.of_kind(first_kind).size());
  const bool complete = executor.for_each(
      parts.size(),
      [&](std::size_t i, std::size_t worker) {
        parts[i] = Enumerator(problem, set, makers[worker], monotone, stop).run(i);
      },
      stop);
  Enumeration all;
  all.complete = complete;
  for (Enumeration& part : parts) {
    all.complete = all.complete && part.complete;
    all.scenes += part.scenes;
    if (part.best && (!all.best || part.best->cost < all.best->cost)) all.best = std::move(part.best);
  }
  return all;
}

}  // namespace perch
