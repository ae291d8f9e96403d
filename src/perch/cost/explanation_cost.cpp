#include "perch/cost/explanation_cost.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "perch/core/error.hpp"

namespace perch {
void CostSettings::check() const {
  if (!std::isfinite(delta) || delta <= 0.0 || delta > 0.1)
    throw InvalidSetting(
        fmt::format("cost.delta is {}; the sensor resolution must lie above 0 and up to 0.1 metres", delta));
  if (!std::isfinite(clutter_weight) || clutter_weight < 1.0 / 64.0 || clutter_weight > 1.0)
    throw InvalidSetting(
        fmt::format("cost.clutter_weight is {}; it must lie between 1/64 and 1", clutter_weight));
}

void enlarge(Composite& composite, const Window& needed) {
  const Window window = bounding(composite.depth.window, needed);
  if (window == composite.depth.window) return;
  DepthPatch depth{window, std::vector<float>(static_cast<std::size_t>(window.width()) *
                                                  static_cast<std::size_t>(window.height()),
                                              no_surface)};
  std::vector<std::uint8_t> explained(depth.depth.size(), 0);
  const Window& old = composite.depth.window;
  for (int v = old.v0; v < old.v1; ++v) {
    const std::size_t from = composite.depth.index(old.u0, v), to = depth.index(old.u0, v);
    const auto n = static_cast<std::ptrdiff_t>(old.width());
    std::copy_n(composite.depth.depth.begin() + static_cast<std::ptrdiff_t>(from), n,
                depth.depth.begin() + static_cast<std::ptrdiff_t>(to));
    std::copy_n(composite.explained.begin() + static_cast<std::ptrdiff_t>(from), n,
                explained.begin() + static_cast<std::ptrdiff_t>(to));
  }
  composite.depth = std::move(depth);
  composite.explained = std::move(explained);
}

ExplanationCost::ExplanationCost(const Observation& observation, const DeltaIndex& index,
                                 const CostSettings& settings)
    : observation_(observation),
      index_(index),
      counted_(observation, settings),
      charges_points_(settings.charges_points()) {}

Composite ExplanationCost::empty() const {
  Composite composite;
  composite.observed = PointSet(observation_.size());
  return composite;
}

CostCounts ExplanationCost::counts(const Composite& composite) const {
  return {charged_points() - composite.observed_count, composite.unexplained};
}

CostCounts ExplanationCost::counts_with(const Composite& composite, const DepthPatch& patch,
                                        CostChange& scratch) const {
  change(composite, patch, scratch);
  CostCounts result = counts(composite);
  result.observed +=
      static_cast<std::int64_t>(scratch.lost.size()) - static_cast<std::int64_t>(scratch.gained.size());
  result.rendered += scratch.unexplained;
  return result;
}

void ExplanationCost::add(Composite& composite, const DepthPatch& patch, CostChange& scratch) const {
  change(composite, patch, scratch);
  enlarge(composite, patch.window);
  for (int v = patch.window.v0; v < patch.window.v1; ++v)
    for (int u = patch.window.u0; u < patch.window.u1; ++u) {
      const float z = patch.at(u, v);
      const std::size_t pixel = composite.depth.index(u, v);
      if (!(z < composite.depth.depth[pixel]) || !counts_at(u, v, z)) continue;
      composite.depth.depth[pixel] = z;
      composite.explained[pixel] = scratch.appears.contains(u, v);
    }
  for (const std::uint32_t i : scratch.gained) composite.observed.insert(i);
  for (const std::uint32_t i : scratch.lost) composite.observed.erase(i);
  composite.observed_count +=
      static_cast<std::int64_t>(scratch.gained.size()) - static_cast<std::int64_t>(scratch.lost.size());
  composite.points += scratch.points;
  composite.unexplained += scratch.unexplained;
}

void ExplanationCost::change(const Composite& composite, const DepthPatch& patch, CostChange& change) const {
  change.points = 0;
  change.unexplained = 0;
  change.gained.clear();
  change.lost.clear();
  change.appears.reset(patch.window);
  change.hides.reset(patch.window);
  change_rendered(composite, patch, change);
  if (charges_points() && (change.appears.any() || change.hides.any()))
    change_observed(composite, patch, change);
}

void ExplanationCost::change_rendered(const Composite& composite, const DepthPatch& patch,
                                      CostChange& change) const {
  for (int v = patch.window.v0; v < patch.window.v1; ++v) {
    const float* row = patch.row(v) - patch.window.u0;
    for (int u = patch.window.u0; u < patch.window.u1; ++u) {
      const float z = row[u];
      if (!(z < no_surface)) continue;
      const float hidden = composite.depth.at_or_none(u, v);
      if (!(z < hidden) || !counts_at(u, v, z)) continue;
      if (index_.explained(u, v, z))
        change.appears.insert(u, v);
      else
        ++change.unexplained;
      if (!(hidden < no_surface)) {
        ++change.points;
      } else if (composite.explained[composite.depth.index(u, v)]) {
        change.hides.insert(u, v);
      } else {
        --change.unexplained;
      }
    }
  }
}

void ExplanationCost::change_observed(const Composite& composite, const DepthPatch& patch,
                                      CostChange& change) const {
  const RaySlopes& rays = observation_.rays();
  const float delta_squared = index_.delta_squared();
  // Only rendered points that some point of I explains can explain a point of I: the same pairs.
  const auto near = [&](const BitWindow& pixels, const DepthPatch& depth, const Eigen::Vector3f& p,
                        const Window& window) {
    return pixels.any_of(window, [&](int u, int v) {
      return within_delta(p, rays.point(u, v, depth.at(u, v)), delta_squared);
    });
  };
  const auto still_near = [&](const Eigen::Vector3f& p, const Window& window) {
    const Window common = intersection(window, composite.depth.window);
    for (int v = common.v0; v < common.v1; ++v)
      for (int u = common.u0; u < common.u1; ++u) {
        const std::size_t pixel = composite.depth.index(u, v);
        if (composite.explained[pixel] && !change.hides.contains(u, v) &&
            within_delta(p, rays.point(u, v, composite.depth.depth[pixel]), delta_squared))
          return true;
      }
    return false;
  };

  const int reach = index_.reach();
  const int first_row = std::max(0, patch.window.v0 - reach);
  const int last_row = std::min(observation_.intrinsics().height, patch.window.v1 + reach);
  const auto& points = observation_.points();
  for (int v = first_row; v < last_row; ++v) {
    const std::size_t end = observation_.row_begin(v + 1);
    for (std::size_t i = observation_.row_begin(v); i < end; ++i) {
      const int u = observation_.column(i);
      if (u < patch.window.u0 - reach) continue;
      if (u >= patch.window.u1 + reach) break;
      const Window& window = index_.window(i);
      if (intersection(window, patch.window).empty()) continue;
      const Eigen::Vector3f& p = points[i];
      const auto appears = [&] {
        return (change.appears.contains(u, v) &&
                within_delta(p, rays.point(u, v, patch.at(u, v)), delta_squared)) ||
               near(change.appears, patch, p, window);
      };
      if (!composite.observed.contains(i)) {
        if (appears()) change.gained.push_back(static_cast<std::uint32_t>(i));
      } else if (change.hides.any() && near(change.hides, composite.depth, p, window) &&
                 !still_near(p, window) && !appears()) {
        change.lost.push_back(static_cast<std::uint32_t>(i));
      }
    }
  }
}

}  // namespace perch
