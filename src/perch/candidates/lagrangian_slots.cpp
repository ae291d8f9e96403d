#include <algorithm>
#include <cmath>
#include <utility>

#include "perch/candidates/lagrangian_bound.hpp"

namespace perch {

void LagrangianBound::widen_certain(std::vector<CandidateMaker>& makers, const Executor& executor) {
  const auto width = static_cast<std::size_t>(problem_.observation().intrinsics().width);
  const int first_row = static_cast<int>(first_pixel_ / width);
  const auto place = [&](int u, int v) {
    return static_cast<std::size_t>(v - first_row) * width + static_cast<std::size_t>(u);
  };
  const std::vector<CandidateId> ids = left();
  // The nearest that the candidates left of each slot can be at a pixel.
  std::vector<std::vector<float>> nearest(slots_.size(), std::vector<float>(pixels_, no_surface));
  const StopCondition never;
  executor.for_each(
      slots_.size(),
      [&](std::size_t slot, std::size_t worker) {
        for (const CandidateId id : ids) {
          if (slot_of_[id] != slot) continue;
          const DepthPatch& patch = makers[worker].patch(set_[id]);
          for (int v = patch.window.v0; v < patch.window.v1; ++v)
            for (int u = patch.window.u0; u < patch.window.u1; ++u)
              nearest[slot][place(u, v)] = std::min(nearest[slot][place(u, v)], patch.at(u, v));
        }
      },
      never);
  const DeltaIndex& index = problem_.cost().index();
  executor.for_each(
      ids.size(),
      [&](std::size_t i, std::size_t worker) {
        const std::size_t own = slot_of_[ids[i]];
        const DepthPatch& patch = makers[worker].patch(set_[ids[i]]);
        std::vector<Run> runs;
        for (int v = patch.window.v0; v < patch.window.v1; ++v)
          for (int u = patch.window.u0; u < patch.window.u1; ++u) {
            const float z = patch.at(u, v);
            if (!(z < no_surface) || !problem_.cost().counts_at(u, v)) continue;
            const auto may_hide = [&] {
              for (std::size_t slot = 0; slot < slots_.size(); ++slot)
                if ((slot != own ? slots_[slot].copies > 0 : slots_[slot].copies > 1) &&
                    nearest[slot][place(u, v)] < z)
                  return true;
              return false;
            };
            if (index.unexplained_throughout(u, v, z, z) || (!index.explained(u, v, z) && !may_hide()))
              append(runs, static_cast<std::uint32_t>(first_pixel_ + place(u, v)));
          }
        certain_[ids[i]] = std::move(runs);
      },
      never);
  share_pixels();
}

void LagrangianBound::share_pixels() {
  // A pixel's weight goes to the slots in proportion to the share of their candidates that it costs a point:
  // once most are dropped, that is nearly always one slot.
  const std::vector<CandidateId> ids = left();
  std::vector<double> candidates(slots_.size(), 0.0);
  for (const CandidateId id : ids) candidates[slot_of_[id]] += 1.0;
  std::vector<std::vector<double>> share(slots_.size(), std::vector<double>(pixels_, 0.0));
  for (const CandidateId id : ids)
    for (const Run& run : certain_[id])
      for (std::uint32_t x = run.first; x < run.last; ++x)
        share[slot_of_[id]][pixel(x)] += 1.0 / candidates[slot_of_[id]];
  for (std::size_t x = 0; x < pixels_; ++x) {
    double total = 0.0;
    for (std::size_t slot = 0; slot < slots_.size(); ++slot) total += slots_[slot].copies * share[slot][x];
    if (total == 0.0) continue;
    Weight sum = 0;
    for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
      slots_[slot].nu[x] = static_cast<Weight>(static_cast<double>(one) * share[slot][x] / total);
      sum += slots_[slot].copies * slots_[slot].nu[x];
    }
    for (Slot& slot : slots_) {  // take off what rounding may have put on top
      if (sum <= one) break;
      const Weight less = std::min(slot.nu[x], sum - one);
      slot.nu[x] -= less;
      sum -= slot.copies * less;
    }
  }
}

void LagrangianBound::separate_copies(const std::vector<CandidateId>& known, int iterations,
                                      std::int64_t upper_bound, const Executor& executor,
                                      const StopCondition& stop) {
  constexpr int most_copies = 4;  // 5 copies have 125 other ways to be shared out
  const std::size_t models = slots_.size();
  for (std::size_t slot = 0; slot < models && !stop(); ++slot) {
    const int copies = slots_[slot].copies;
    std::vector<CandidateId> places;
    for (const CandidateId id : known)
      if (slot_of_[id] == slot) places.push_back(id);
    if (copies < 2 || copies > most_copies || places.size() != static_cast<std::size_t>(copies)) continue;

    LagrangianBound apart = *this;
    std::vector<std::size_t> parts{slot};
    while (parts.size() < places.size()) parts.push_back(apart.add_slot(0));
    for (const CandidateId id : left()) {
      if (slot_of_[id] != slot) continue;
      const auto distance = [&](CandidateId place) {
        const Pose &a = set_[id].pose, &b = set_[place].pose;
        return std::hypot(a.x - b.x, a.y - b.y);
      };
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < places.size(); ++i)
        if (distance(places[i]) < distance(places[nearest])) nearest = i;
      apart.slot_of_[id] = parts[nearest];
    }
    for (const std::size_t part : parts) apart.slots_[part].nu = slots_[slot].nu;

    // All ways to share out the copies but one each.
    std::vector<int> shares(places.size(), 0);
    shares[0] = copies;
    bool closed = true;
    while (closed) {
      const bool one_each = std::all_of(shares.begin(), shares.end(), [](int n) { return n == 1; });
      if (!one_each) {
        LagrangianBound trial = apart;
        for (std::size_t i = 0; i < parts.size(); ++i) {
          trial.slots_[parts[i]].copies = shares[i];
          for (const CandidateId id : trial.left())
            if (shares[i] == 0 && trial.slot_of_[id] == parts[i]) trial.kept_[id] = 0;
        }
        trial.improve(iterations, upper_bound, static_cast<double>(upper_bound), executor, stop);
        closed = trial.lower_bound() >= upper_bound;
      }
      // The next composition of `copies` into parts, in colexicographic order.
      if (shares.back() == copies) break;
      std::size_t first = 0;
      while (shares[first] == 0) ++first;
      const int moved = std::exchange(shares[first], 0);
      shares[0] = moved - 1;
      ++shares[first + 1];
    }
    if (!closed) continue;
    for (const std::size_t part : parts) apart.slots_[part].copies = 1;
    slots_ = std::move(apart.slots_);
    slot_of_ = std::move(apart.slot_of_);
  }
}

}  // namespace perch
