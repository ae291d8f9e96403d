#include "perch/cost/lone_cost.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "perch/core/instruction_set.hpp"

namespace perch {
namespace {

/// What the two passes go by.
struct LoneFrame {
  const DeltaIndex* index;
  const PixelRows* rows;
  const float *slope_x, *slope_y;
  float delta, delta_squared;
  std::uint32_t image_width;
  Window patch, area;
  float* rendered;  ///< of area, which is `blocks` times lane_count wide
  std::ptrdiff_t pitch;
  int blocks;
  float *nearest, *farthest;  ///< of blocks of lane_count columns and rows

  Window window_of(const float* p) const {
    return ball_window(index->observation().intrinsics(), Eigen::Vector3f(p[0], p[1], p[2]), index->delta());
  }
};

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

void LoneCost::load(const DepthPatch& patch) {
  const Intrinsics& intrinsics = cost_.observation().intrinsics();
  const int reach = cost_.index().reach();
  area_ = intersection(
      {patch.window.u0 - reach, patch.window.v0 - reach, patch.window.u1 + reach, patch.window.v1 + reach},
      intrinsics.window());
  const int blocks = (area_.width() + lane_count - 1) / lane_count;
  pitch_ = static_cast<std::size_t>(blocks + 1) * lane_count;
  rendered_.assign(pitch_ * static_cast<std::size_t>(area_.height()), no_surface);
  for (int v = patch.window.v0; v < patch.window.v1; ++v) {
    float* target =
        rendered_.data() + static_cast<std::size_t>(v - area_.v0) * pitch_ + (patch.window.u0 - area_.u0);
    std::copy_n(patch.row(v), patch.window.width(), target);
    if (cost_.counts_everywhere()) continue;
    for (int u = patch.window.u0; u < patch.window.u1; ++u, ++target)
      if (!cost_.counts_at(u, v)) *target = no_surface;
  }
}

void LoneCost::value(const DepthPatch& patch, LoneValue& value) {
  value.points = value.unexplained = value.exposed = value.explained_count = 0;
  value.explained.clear();
  value.certain.clear();
  value.uncertain.clear();
  value.shown.clear();
  if (patch.window.empty()) return;
  load(patch);
  const DeltaIndex& index = cost_.index();
  const int blocks = (area_.width() + lane_count - 1) / lane_count;
  const int block_rows = (area_.height() + lane_count - 1) / lane_count;
  const std::size_t size = static_cast<std::size_t>(blocks) * static_cast<std::size_t>(block_rows);
  nearest_.assign(size, no_surface);
  farthest_.assign(size, -no_surface);
  const LoneFrame frame{&index,
                        &index.rows(),
                        index.rows().slope_x.data(),
                        index.rows().slope_y.data(),
                        static_cast<float>(index.delta()),
                        index.delta_squared(),
                        static_cast<std::uint32_t>(cost_.observation().intrinsics().width),
                        patch.window,
                        area_,
                        rendered_.data(),
                        static_cast<std::ptrdiff_t>(pitch_),
                        blocks,
                        nearest_.data(),
                        farthest_.data()};
  PERCH_CALL(value_rendered, frame, value);
  if (value.unexplained == value.points) return;
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
}

}  // namespace perch
