#include "perch/tree/monotone.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "perch/core/error.hpp"

namespace perch {
namespace {

bool touch(const DepthPatch& a, const DepthPatch& b) {
  const Window common = intersection(a.window, b.window);
  for (int v = common.v0; v < common.v1; ++v)
    for (int u = common.u0; u < common.u1; ++u)
      if (a.at(u, v) < no_surface && b.at(u, v) < no_surface) return true;
  return false;
}

/// Depth-first over sets of placed objects; a set that led nowhere is not tried again.
class OrderSearch {
 public:
  OrderSearch(const ExplanationCost& cost, const std::vector<const DepthPatch*>& patches,
              const MonotoneSettings& settings)
      : cost_(cost), patches_(patches), settings_(settings), placed_(patches.size(), false) {}

  bool exists(std::size_t count = 0, const DepthPatch& composite = {}) {
    if (count == patches_.size()) return true;
    if (failed_.contains(placed_)) return false;
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      if (placed_[i] || !keeps_monotone(cost_, composite, *patches_[i], settings_)) continue;
      placed_[i] = true;
      const bool found = exists(count + 1, compose({&composite, patches_[i]}));
      if (found) return true;
      placed_[i] = false;
    }
    failed_.insert(placed_);
    return false;
  }

 private:
  const ExplanationCost& cost_;
  const std::vector<const DepthPatch*>& patches_;
  const MonotoneSettings& settings_;
  std::vector<bool> placed_;
  std::set<std::vector<bool>> failed_;
};

}  // namespace

void MonotoneSettings::check() const {
  if (!(depth_tolerance >= 0.0 && depth_tolerance <= 1.0))
    throw InvalidSetting(
        fmt::format("tree.depth_tolerance is {}; it must lie between 0 and 1 metre", depth_tolerance));
  if (pixel_tolerance < 0)
    throw InvalidSetting(
        fmt::format("tree.pixel_tolerance is {}; it must be 0 or more pixels", pixel_tolerance));
}

bool keeps_monotone(const ExplanationCost& cost, const DepthPatch& composite, const DepthPatch& patch,
                    const MonotoneSettings& settings) {
  const Window common = intersection(composite.window, patch.window);
  const float tolerance = static_cast<float>(settings.depth_tolerance);
  int deeper = 0;
  for (int v = common.v0; v < common.v1; ++v)
    for (int u = common.u0; u < common.u1; ++u) {
      const float covered = composite.at(u, v);
      if (!(covered < no_surface) || !(patch.at(u, v) < covered - tolerance) ||
          !cost.counts_at(u, v, covered))
        continue;
      if (++deeper > settings.pixel_tolerance) return false;
    }
  return true;
}

bool monotone_order_exists(const ExplanationCost& cost, const std::vector<DepthPatch>& patches,
                           const MonotoneSettings& settings) {
  // Objects whose images don't touch have no order between them: each connected group is a question of its
  // own.
  std::vector<std::size_t> group(patches.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (std::size_t i = 0; i < patches.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (group[i] != group[j] && touch(patches[i], patches[j])) {
        const auto [kept, replaced] = std::minmax({group[i], group[j]});  // copies: the elements change
        std::replace(group.begin(), group.end(), replaced, kept);
      }
  const auto nearest = [](const DepthPatch& patch) {
    return *std::min_element(patch.depth.begin(), patch.depth.end());
  };
  for (std::size_t g = 0; g < patches.size(); ++g) {
    std::vector<const DepthPatch*> members;
    for (std::size_t i = 0; i < patches.size(); ++i)
      if (group[i] == g && !patches[i].depth.empty()) members.push_back(&patches[i]);
    std::stable_sort(members.begin(), members.end(),
                     [&](const DepthPatch* a, const DepthPatch* b) { return nearest(*a) < nearest(*b); });
    if (!OrderSearch(cost, members, settings).exists()) return false;
  }
  return true;
}

}  // namespace perch
