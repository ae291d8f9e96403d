#include "perch/baselines/greedy_orders.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <set>
#include <unordered_map>
#include <utility>

namespace perch {
namespace {

/// A pose of a model, placed.
struct Chosen {
  std::uint32_t model, pose;
  friend auto operator<=>(const Chosen&, const Chosen&) = default;
};

/// What an order is worth; less is better.
struct Worth {
  std::int64_t left_out = std::numeric_limits<std::int64_t>::max();
  std::int64_t misfit = 0;
  friend auto operator<=>(const Worth&, const Worth&) = default;
};

class OrderSearch {
 public:
  OrderSearch(const GreedyPlacing& placing, const StopCondition& stop)
      : placing_(placing), stop_(stop), left_(placing.misfits.size(), 0) {
    for (const std::size_t model : placing.objects) ++left_[model];
  }

  BestOrder run() {
    std::vector<std::size_t> first(left_.size(), 0);
    extend({}, first);
    BestOrder best;
    best.complete = complete_;
    std::vector<std::size_t> next(left_.size(), 0);
    for (const std::size_t model : placing_.objects) {
      std::size_t& i = next[model];
      while (i < best_.size() && best_[i].model != model) ++i;
      best.poses.push_back(i < best_.size() ? std::optional<std::size_t>(best_[i++].pose) : std::nullopt);
    }
    return best;
  }

 private:
  /// \param placed ascending. \param first of each model: no pose before this one is free.
  void extend(const std::vector<Chosen>& placed, std::vector<std::size_t> first) {
    // One order at least is followed to its end.
    if (worth_.left_out != std::numeric_limits<std::int64_t>::max() && stop_()) complete_ = false;
    if (!complete_ || !met_.insert(placed).second) return;
    bool ends = true;
    Worth least;
    least.left_out = 0;
    for (const Chosen& chosen : placed) least.misfit += misfit(chosen);
    for (std::size_t model = 0; model < left_.size(); ++model) {
      if (left_[model] == 0) continue;
      const std::size_t poses = placing_.misfits[model].size();
      while (first[model] < poses && blocked(model, first[model], placed)) ++first[model];
      if (first[model] == poses) {
        least.left_out += left_[model];
        continue;
      }
      ends = false;
      least.misfit += left_[model] * placing_.misfits[model][first[model]];
    }
    if (ends) {
      if (least < worth_) {
        worth_ = least;
        best_ = placed;
      }
      return;
    }
    if (!(least < worth_)) return;
    for (std::size_t model = 0; model < left_.size(); ++model) {
      if (left_[model] == 0 || first[model] == placing_.misfits[model].size()) continue;
      std::vector<Chosen> more = placed;
      const Chosen next{static_cast<std::uint32_t>(model), static_cast<std::uint32_t>(first[model])};
      more.insert(std::lower_bound(more.begin(), more.end(), next), next);
      --left_[model];
      extend(more, first);
      ++left_[model];
    }
  }

  std::int64_t misfit(const Chosen& chosen) const { return placing_.misfits[chosen.model][chosen.pose]; }

  bool blocked(std::size_t model, std::size_t pose, const std::vector<Chosen>& placed) {
    const Chosen candidate{static_cast<std::uint32_t>(model), static_cast<std::uint32_t>(pose)};
    return std::any_of(placed.begin(), placed.end(), [&](const Chosen& other) {
      if (other == candidate) return true;
      const auto [it, is_new] = collisions_.try_emplace(std::minmax(candidate, other), false);
      if (is_new) it->second = placing_.collide(model, pose, other.model, other.pose);
      return it->second;
    });
  }

  struct PairHash {
    std::size_t operator()(const std::pair<Chosen, Chosen>& pair) const {
      std::uint64_t hash = 0;
      for (const std::uint32_t x : {pair.first.model, pair.first.pose, pair.second.model, pair.second.pose})
        hash = (hash ^ x) * 0x9e3779b97f4a7c15U + (hash >> 29U);
      return hash;
    }
  };

  const GreedyPlacing& placing_;
  const StopCondition& stop_;
  std::vector<int> left_;  ///< of each model: copies to be placed
  std::set<std::vector<Chosen>> met_;
  std::unordered_map<std::pair<Chosen, Chosen>, bool, PairHash> collisions_;
  std::vector<Chosen> best_;
  Worth worth_;
  bool complete_ = true;
};

}  // namespace

BestOrder best_order(const GreedyPlacing& placing, const StopCondition& stop) {
  return OrderSearch(placing, stop).run();
}

}  // namespace perch
