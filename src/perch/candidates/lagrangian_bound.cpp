#include "perch/candidates/lagrangian_bound.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perch {
namespace {

/// The candidates of the objects, kind by kind; a kind's objects are a slot.
Covering covering_of(const LocalizationProblem& problem, const CandidateSet& set,
                     std::vector<CandidateId>& ids) {
  const Intrinsics& intrinsics = problem.observation().intrinsics();
  Covering covering;
  covering.points = static_cast<std::size_t>(problem.cost().charged_points());
  covering.pixels = static_cast<std::size_t>(intrinsics.width) * static_cast<std::size_t>(intrinsics.height);
  for (std::size_t kind = 0; kind < problem.kinds(); ++kind) {
    if (problem.copies()[kind] == 0) continue;
    const auto slot = static_cast<std::uint32_t>(covering.copies.size());
    covering.copies.push_back(problem.copies()[kind]);
    for (const CandidateId id : set.of_kind(kind)) {
      covering.options.push_back({slot, set[id].explained_runs, set[id].certain_runs, set[id].uncertain_runs,
                                  set[id].explained_pixels});
      ids.push_back(id);
    }
  }
  return covering;
}

template <typename T>
std::vector<T> chosen(const std::vector<T>& values, const std::vector<std::uint32_t>& numbers) {
  std::vector<T> result;
  for (const std::uint32_t i : numbers) result.push_back(values[i]);
  return result;
}

/// The union of two disjoint sets.
std::vector<Run> merged(const std::vector<Run>& a, const std::vector<Run>& b) {
  std::vector<Run> all;
  std::merge(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all),
             [](const Run& x, const Run& y) { return x.first < y.first; });
  return all;
}

/// Calls `visit` with every way to share out `copies` to `parts`, one each left out; stops where it says no.
template <typename Visit>
bool for_each_sharing(int copies, std::size_t parts, Visit visit) {
  std::vector<int> shares(parts, 0);
  shares[0] = copies;
  while (true) {
    const bool one_each = std::all_of(shares.begin(), shares.end(), [](int n) { return n == 1; });
    if (!one_each && !visit(shares)) return false;
    // The next composition in colexicographic order.
    if (shares.back() == copies) return true;
    std::size_t first = 0;
    while (shares[first] == 0) ++first;
    const int moved = std::exchange(shares[first], 0);
    shares[0] = moved - 1;
    ++shares[first + 1];
  }
}

}  // namespace

LagrangianBound::LagrangianBound(const LocalizationProblem& problem, const CandidateSet& set,
                                 const CoarseDual* start)
    : problem_(problem), set_(set), slot_of_(set.size(), 0), lagrangian_([&] {
        Covering covering = covering_of(problem, set, ids_);
        CoveringNumbers left = perch::compact(covering);
        point_of_ = std::move(left.points);
        pixel_of_ = std::move(left.pixels);
        return covering;
      }()) {
  for (std::size_t i = 0; i < ids_.size(); ++i) slot_of_[ids_[i]] = lagrangian_.covering().options[i].slot;
  if (start != nullptr) take_weights(*start);
}

void LagrangianBound::take_weights(const CoarseDual& start) {
  const std::vector<Lagrangian::Weight> mu = start.point_weights();
  for (std::size_t i = 0; i < point_of_.size(); ++i) lagrangian_.set_point_weight(i, mu[point_of_[i]]);
  std::size_t slot = 0;
  for (std::size_t kind = 0; kind < problem_.kinds(); ++kind) {
    if (problem_.copies()[kind] == 0) continue;
    for (std::size_t x = 0; x < pixel_of_.size(); ++x)
      lagrangian_.set_pixel_weight(slot, x, start.pixel_weight(kind, pixel_of_[x]));
    ++slot;
  }
}

void LagrangianBound::compact() {
  const Lagrangian::Left left = lagrangian_.compact();
  ids_ = chosen(ids_, left.options);
  point_of_ = chosen(point_of_, left.points);
  pixel_of_ = chosen(pixel_of_, left.pixels);
}

std::vector<char> LagrangianBound::kept() const {
  std::vector<char> kept(set_.size(), 0);
  for (std::size_t i = 0; i < ids_.size(); ++i) kept[ids_[i]] = lagrangian_.kept(i);
  return kept;
}

std::vector<Lagrangian::Weight> LagrangianBound::point_weights() const {
  std::vector<Lagrangian::Weight> weights(problem_.observation().size(), Lagrangian::one);
  for (std::size_t i = 0; i < point_of_.size(); ++i) weights[point_of_[i]] = lagrangian_.point_weight(i);
  return weights;
}

ReducedCosts LagrangianBound::reduced_costs() const {
  std::vector<Lagrangian::Weight> reduced(set_.size(), 0);
  for (std::size_t i = 0; i < ids_.size(); ++i) reduced[ids_[i]] = lagrangian_.reduced_cost(i);
  return {lagrangian_.base(), std::move(reduced)};
}

void LagrangianBound::improve(int iterations, std::int64_t upper_bound, double enough,
                              const Executor& executor, const StopCondition& stop) {
  lagrangian_.improve(iterations, upper_bound, enough, executor, stop);
  if (2 * lagrangian_.kept_count() < ids_.size()) compact();
}

void LagrangianBound::widen_certain(std::vector<CandidateMaker>& makers, const Executor& executor) {
  const auto width = static_cast<std::uint32_t>(problem_.observation().intrinsics().width);
  const auto depth_at = [&](const DepthPatch& patch, std::uint32_t x) {
    return patch.at(static_cast<int>(pixel_of_[x] % width), static_cast<int>(pixel_of_[x] / width));
  };
  const Covering& covering = lagrangian_.covering();
  const std::vector<int>& copies = covering.copies;
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < ids_.size(); ++i)
    if (lagrangian_.kept(i)) left.push_back(i);
  // The nearest explained points that the candidates left of each slot can show at a pixel.
  std::vector<std::vector<float>> nearest(copies.size(), std::vector<float>(covering.pixels, no_surface));
  const StopCondition never;
  executor.for_each(
      copies.size(),
      [&](std::size_t slot, std::size_t worker) {
        for (const std::size_t i : left) {
          if (covering.options[i].slot != slot || covering.options[i].relieved.empty()) continue;
          const DepthPatch& patch = makers[worker].patch(set_[ids_[i]]);
          for (const Run& run : covering.options[i].relieved)
            for (std::uint32_t x = run.first; x < run.last; ++x)
              nearest[slot][x] = std::min(nearest[slot][x], depth_at(patch, x));
        }
      },
      never);
  executor.for_each(
      left.size(),
      [&](std::size_t i, std::size_t worker) {
        const Covering::Option& option = covering.options[left[i]];
        if (option.uncertain.empty()) return;
        const DepthPatch& patch = makers[worker].patch(set_[ids_[left[i]]]);
        std::vector<Run> certain, uncertain;
        for (const Run& run : option.uncertain)
          for (std::uint32_t x = run.first; x < run.last; ++x) {
            const float z = depth_at(patch, x);
            const auto may_hide = [&] {
              for (std::size_t slot = 0; slot < copies.size(); ++slot)
                if ((slot != option.slot ? copies[slot] > 0 : copies[slot] > 1) && nearest[slot][x] < z)
                  return true;
              return false;
            };
            append(may_hide() ? uncertain : certain, x);
          }
        if (!certain.empty())
          lagrangian_.set_unexplained(left[i], merged(option.certain, certain), std::move(uncertain));
      },
      never);
  lagrangian_.share_pixels();
}

void LagrangianBound::separate_copies(const std::vector<CandidateId>& known, int iterations,
                                      std::int64_t upper_bound, const Executor& executor,
                                      const StopCondition& stop) {
  constexpr int most_copies = 4;  // 5 copies have 125 other ways to be shared out
  const std::size_t slots = copies().size();
  for (std::size_t slot = 0; slot < slots && !stop(); ++slot) {
    const int copies = this->copies()[slot];
    std::vector<CandidateId> places;
    for (const CandidateId id : known)
      if (this->slot(id) == slot && !set_[id].absent) places.push_back(id);
    if (copies < 2 || copies > most_copies || places.size() != static_cast<std::size_t>(copies)) continue;

    Lagrangian apart = lagrangian_;
    std::vector<std::size_t> parts{slot};
    while (parts.size() < places.size()) parts.push_back(apart.add_slot(0, slot));
    bool all_placed = true;
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      const Candidate& candidate = set_[ids_[i]];
      if (!apart.kept(i) || apart.covering().options[i].slot != slot) continue;
      all_placed = all_placed && !candidate.absent;  // one that is left out has no place
      const auto distance = [&](CandidateId place) {
        return std::hypot(candidate.pose.x - set_[place].pose.x, candidate.pose.y - set_[place].pose.y);
      };
      std::size_t nearest = 0;
      for (std::size_t p = 1; p < places.size(); ++p)
        if (distance(places[p]) < distance(places[nearest])) nearest = p;
      apart.set_slot(i, parts[nearest]);
    }
    if (!all_placed) continue;

    const bool closed = for_each_sharing(copies, parts.size(), [&](const std::vector<int>& shares) {
      Lagrangian trial = apart;
      for (std::size_t p = 0; p < parts.size(); ++p) {
        trial.set_copies(parts[p], shares[p]);
        for (std::size_t i = 0; i < ids_.size(); ++i)
          if (shares[p] == 0 && trial.covering().options[i].slot == parts[p]) trial.drop(i);
      }
      trial.improve(iterations, upper_bound, static_cast<double>(upper_bound), executor, stop);
      return trial.lower_bound() >= upper_bound;
    });
    if (!closed) continue;
    for (const std::size_t part : parts) apart.set_copies(part, 1);
    lagrangian_ = std::move(apart);
    for (std::size_t i = 0; i < ids_.size(); ++i) slot_of_[ids_[i]] = lagrangian_.covering().options[i].slot;
  }
}

}  // namespace perch
