#include "perch/cost/lone_cost.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "perch/core/instruction_set.hpp"

namespace perch {
namespace {

/// What the two passes go by.
struct LoneFrame {
  const PixelRows* rows;
  const float *slope_x, *slope_y;
  float delta, delta_squared;
  float ball_reach;  ///< pixels at a distance of 1 m
  int most_reach;
  std::uint32_t image_width;
  int image_height;
  Window patch, area;
  float* rendered;  ///< of area, which is `blocks` times lane_count wide
  std::ptrdiff_t pitch;
  int blocks;
  float *nearest, *farthest;  ///< of blocks of lane_count columns and rows

  /// Rows and columns from the pixel that a point at depth z is seen at to any within delta of it. The slopes
  /// x / z of a ball around a point lie within delta sqrt(1 + (x / z)^2) / (z - delta) of the point's own.
  int reach_at(float z) const {
    constexpr float slack = 0.1F;  // pixels; of rounding
    const float reach = z > delta ? ball_reach / (z - delta) + slack : static_cast<float>(most_reach);
    return reach < static_cast<float>(most_reach) ? static_cast<int>(reach) : most_reach;
  }
};

/// LoneFrame::ball_reach for any point that is in the image.
float ball_reach(const DeltaIndex& index) {
  const Intrinsics& k = index.observation().intrinsics();
  const RaySlopes& rays = index.observation().rays();
  const float x = std::max(std::abs(rays.x(0)), std::abs(rays.x(k.width - 1)));
  const float y = std::max(std::abs(rays.y(0)), std::abs(rays.y(k.height - 1)));
  return static_cast<float>(index.delta() * std::max(k.fx, k.fy)) * std::hypot(1.0F, std::max(x, y));
}

}  // namespace
}  // namespace perch

#define PERCH_KERNELS "perch/cost/lone_cost.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {
namespace {

/// Replaces each number by the least (or greatest) of those up to `reach` places away along an axis.
template <typename Better>
void widen(const std::vector<float>& from, std::vector<float>& to, int count, std::ptrdiff_t step, int lines,
           std::ptrdiff_t line_step, int reach, Better better) {
  for (int line = 0; line < lines; ++line)
    for (int i = 0; i < count; ++i) {
      const float* source = from.data() + line * line_step;
      float best = source[i * step];
      for (int k = std::max(0, i - reach); k <= std::min(count - 1, i + reach); ++k)
        if (better(source[k * step], best)) best = source[k * step];
      to[static_cast<std::size_t>(line * line_step + i * step)] = best;
    }
}

}  // namespace

LoneCost::LoneCost(const ExplanationCost& cost) : cost_(cost), ball_reach_(ball_reach(cost.index())) {}

void LoneCost::load(const DepthPatch& patch, const Composite* composite) {
  const Intrinsics& intrinsics = cost_.observation().intrinsics();
  const int reach = cost_.index().reach();
  area_ = intersection(
      {patch.window.u0 - reach, patch.window.v0 - reach, patch.window.u1 + reach, patch.window.v1 + reach},
      intrinsics.window());
  // Read in whole lanes, and as far beside them as a ball reaches.
  const int blocks = (area_.width() + lane_count - 1) / lane_count;
  pitch_ = static_cast<std::size_t>(blocks * lane_count + reach);
  rendered_.assign(pitch_ * static_cast<std::size_t>(area_.height()) + 2 * static_cast<std::size_t>(reach),
                   no_surface);
  const Window common = composite == nullptr ? Window() : intersection(patch.window, composite->depth.window);
  for (int v = patch.window.v0; v < patch.window.v1; ++v) {
    float* row = rendered_row(v);
    std::copy_n(patch.row(v), patch.window.width(), row + patch.window.u0);
    if (v >= common.v0 && v < common.v1 && !common.empty()) {
      const float* front = composite->depth.row(v) - composite->depth.window.u0;
      for (int u = common.u0; u < common.u1; ++u) row[u] = row[u] < front[u] ? row[u] : no_surface;
    }
    if (cost_.counts_everywhere()) continue;
    for (int u = patch.window.u0; u < patch.window.u1; ++u)
      if (!cost_.counts_at(u, v, row[u])) row[u] = no_surface;
  }
}

void LoneCost::value(const DepthPatch& patch, LoneValue& value) {
  if (!patch.window.empty()) load(patch, nullptr);
  value_loaded(patch, value, std::numeric_limits<std::int64_t>::max());
}

std::optional<CostCounts> LoneCost::counts_with(const Composite& composite, const DepthPatch& patch,
                                                std::int64_t most) {
  CostCounts counts = cost_.counts(composite);
  if (!patch.window.empty() && !change(composite, patch, most, counts)) return std::nullopt;
  if (counts.total() > most) return std::nullopt;
  return counts;
}

bool LoneCost::change(const Composite& composite, const DepthPatch& patch, std::int64_t most,
                      CostCounts& counts) {
  load(patch, &composite);
  counts.rendered -= find_hidden(composite, patch);
  // Nothing that is hidden makes a point of I explained.
  const std::int64_t least = counts.total() - most_gained(composite);
  if (!value_loaded(patch, beside_, most - least)) return false;
  explained_ = PointSet(beside_.explained);
  find_lost(composite);
  counts.rendered += beside_.unexplained;
  counts.observed += static_cast<std::int64_t>(lost_.size()) -
                     static_cast<std::int64_t>(explained_.count_not_in(composite.observed));
  return true;
}

void LoneCost::add(Composite& composite, const DepthPatch& patch) {
  if (patch.window.empty()) return;
  const CostCounts before = cost_.counts(composite);
  CostCounts after = before;
  change(composite, patch, std::numeric_limits<std::int64_t>::max(), after);
  composite.unexplained += after.rendered - before.rendered;
  composite.observed_count -= after.observed - before.observed;
  composite.observed.insert_all(explained_);
  for (const std::uint32_t i : lost_) composite.observed.erase(i);
  enlarge(composite, patch.window);
  for (int v = patch.window.v0; v < patch.window.v1; ++v) {
    const float* explained = rendered_row(v);  // what else was rendered is gone
    const float* rendered = patch.row(v) - patch.window.u0;
    float* depths = composite.depth.row(v) - composite.depth.window.u0;
    std::uint8_t* marks = composite.explained.data() + composite.depth.index(composite.depth.window.u0, v) -
                          composite.depth.window.u0;
    for (int u = patch.window.u0; u < patch.window.u1; ++u) {
      if (!(rendered[u] < depths[u]) || !cost_.counts_at(u, v, rendered[u])) continue;
      composite.points += !(depths[u] < no_surface);
      depths[u] = rendered[u];
      marks[u] = explained[u] < no_surface;
    }
  }
}

std::int64_t LoneCost::most_gained(const Composite& composite) const {
  const PixelRows& rows = cost_.index().rows();
  std::int64_t gained = 0;
  if (!cost_.charges_points()) return gained;
  for (int v = area_.v0; v < area_.v1; ++v) {
    const std::uint32_t* numbers = rows.number.data() + rows.row(v);
    const std::size_t first = numbers[area_.u0], last = area_.u1 < cost_.observation().intrinsics().width
                                                            ? numbers[area_.u1]
                                                            : cost_.observation().row_begin(v + 1);
    gained += static_cast<std::int64_t>(last - first - composite.observed.count_between(first, last));
  }
  return gained;
}

std::int64_t LoneCost::find_hidden(const Composite& composite, const DepthPatch& patch) {
  const Window common = intersection(patch.window, composite.depth.window);
  hidden_ = {};
  std::int64_t unexplained = 0;
  if (common.empty()) return unexplained;
  hides_.reset(common);
  for (int v = common.v0; v < common.v1; ++v) {
    const float* shown = rendered_row(v);
    const float* before = composite.depth.row(v) - composite.depth.window.u0;
    const std::uint8_t* explained =
        composite.explained.data() + composite.depth.index(composite.depth.window.u0, v);
    for (int u = common.u0; u < common.u1; ++u) {
      if (!(shown[u] < no_surface) || !(before[u] < no_surface)) continue;
      if (explained[u - composite.depth.window.u0] == 0) {
        ++unexplained;
      } else {
        hides_.insert(u, v);
        hidden_ = bounding(hidden_, {u, v, u + 1, v + 1});
      }
    }
  }
  return unexplained;
}

void LoneCost::find_lost(const Composite& composite) {
  lost_.clear();
  if (hidden_.empty() || !cost_.charges_points()) return;
  const Observation& observation = cost_.observation();
  const DeltaIndex& index = cost_.index();
  const RaySlopes& rays = observation.rays();
  // Only explained pixels can be near a point of I: the same pairs.
  const auto near = [&](const Eigen::Vector3f& p, int u, int v) {
    return within_delta(p, rays.point(u, v, composite.depth.at(u, v)), index.delta_squared());
  };
  const auto still_near = [&](const Eigen::Vector3f& p, const Window& window) {
    const Window common = intersection(window, composite.depth.window);
    for (int v = common.v0; v < common.v1; ++v)
      for (int u = common.u0; u < common.u1; ++u)
        if (composite.explained[composite.depth.index(u, v)] != 0 && !hides_.contains(u, v) && near(p, u, v))
          return true;
    return false;
  };
  const int first_row = std::max(0, hidden_.v0 - index.reach()),
            last_row = std::min(observation.intrinsics().height, hidden_.v1 + index.reach());
  for (int v = first_row; v < last_row; ++v)
    for (std::size_t i = observation.row_begin(v); i < observation.row_begin(v + 1); ++i) {
      const int u = observation.column(i);
      if (u < hidden_.u0 - index.reach()) continue;
      if (u >= hidden_.u1 + index.reach()) break;
      const Window& window = index.window(i);
      if (!composite.observed.contains(i) || explained_.contains(i) || intersection(window, hidden_).empty())
        continue;
      const Eigen::Vector3f& p = observation.points()[i];
      if (hides_.any_of(window, [&](int x, int y) { return near(p, x, y); }) && !still_near(p, window))
        lost_.push_back(static_cast<std::uint32_t>(i));
    }
}

bool LoneCost::value_loaded(const DepthPatch& patch, LoneValue& value, std::int64_t most_unexplained) {
  value.points = value.unexplained = value.exposed = value.explained_count = 0;
  value.explained.clear();
  value.certain.clear();
  value.uncertain.clear();
  value.shown.clear();
  if (patch.window.empty()) return true;
  const DeltaIndex& index = cost_.index();
  const int blocks = (area_.width() + lane_count - 1) / lane_count;
  const int block_rows = (area_.height() + lane_count - 1) / lane_count;
  const std::size_t size = static_cast<std::size_t>(blocks) * static_cast<std::size_t>(block_rows);
  nearest_.assign(size, no_surface);
  farthest_.assign(size, -no_surface);
  const Intrinsics& intrinsics = cost_.observation().intrinsics();
  const LoneFrame frame{&index.rows(),
                        index.rows().slopes(),
                        index.rows().slope_y.data(),
                        static_cast<float>(index.delta()),
                        index.delta_squared(),
                        ball_reach_,
                        index.reach(),
                        static_cast<std::uint32_t>(intrinsics.width),
                        intrinsics.height,
                        patch.window,
                        area_,
                        rendered_row(area_.v0) + area_.u0,
                        static_cast<std::ptrdiff_t>(pitch_),
                        blocks,
                        nearest_.data(),
                        farthest_.data()};
  if (!PERCH_CALL(value_rendered, frame, most_unexplained, value)) return false;
  if (!cost_.charges_points()) {
    value.exposed = value.unexplained;  // the cost says already what hiding is worth
    return true;
  }
  if (value.unexplained == value.points) return true;
  // The explained depths that a point of I in a block can be near.
  const int reach = (index.reach() + lane_count - 1) / lane_count;
  row_nearest_.resize(size);
  row_farthest_.resize(size);
  const auto less = [](float a, float b) { return a < b; };
  const auto more = [](float a, float b) { return a > b; };
  widen(nearest_, row_nearest_, blocks, 1, block_rows, blocks, reach, less);
  widen(row_nearest_, nearest_, block_rows, blocks, blocks, 1, reach, less);
  widen(farthest_, row_farthest_, blocks, 1, block_rows, blocks, reach, more);
  widen(row_farthest_, farthest_, block_rows, blocks, blocks, 1, reach, more);
  PERCH_CALL(value_observed, frame, value);
  return true;
}

}  // namespace perch
