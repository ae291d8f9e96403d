#include "perch/observation/delta_index.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace perch {
namespace {

/// The pixels u0 to u1 of a row whose rays may meet a ball around p.
struct BallRow {
  const float* slope_x;
  float *nearest, *farthest;  ///< of the row's pixels, taken in
  float slope_y;
  float p[3];
  float radius_squared;
  int u0, u1;
};

}  // namespace
}  // namespace perch

#define PERCH_KERNELS "perch/observation/delta_index.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {
namespace {

/// Slopes t of the lines X = t Z through the origin that meet the disc of radius delta around (x, z).
std::pair<double, double> tangent_slopes(double x, double z, double delta) {
  constexpr double all = std::numeric_limits<double>::infinity();
  const double denominator = z * z - delta * delta;
  if (denominator <= 0.0 || z <= 0.0) return {-all, all};  // the disc reaches the camera's plane
  const double root = delta * std::sqrt(x * x + denominator);
  return {(x * z - root) / denominator, (x * z + root) / denominator};
}

std::pair<int, int> pixel_range(std::pair<double, double> slopes, double focal, double centre, int size) {
  constexpr double slack = 0.02;  // pixels; covers the rounding of float points and slopes
  const double low =
      std::clamp(std::ceil(slopes.first * focal + centre - slack), 0.0, static_cast<double>(size));
  const double high =
      std::clamp(std::floor(slopes.second * focal + centre + slack), -1.0, static_cast<double>(size - 1));
  return {static_cast<int>(low), static_cast<int>(high) + 1};
}

std::vector<Window> ball_windows(const Observation& observation, double delta, const Executor& executor,
                                 const StopCondition& stop) {
  const Intrinsics& intrinsics = observation.intrinsics();
  std::vector<Window> windows(observation.size());
  if (!executor.for_each(
          static_cast<std::size_t>(intrinsics.height),
          [&](std::size_t row, std::size_t) {
            const int v = static_cast<int>(row);
            for (std::size_t i = observation.row_begin(v); i < observation.row_begin(v + 1); ++i)
              windows[i] = ball_window(intrinsics, observation.points()[i], delta);
          },
          stop))
    throw Interrupted();
  return windows;
}

/// The most rows or columns from a point's own pixel to the end of its window.
int farthest_from_own_pixel(const Observation& observation, const std::vector<Window>& windows) {
  int farthest = 0;
  for (int v = 0; v < observation.intrinsics().height; ++v)
    for (std::size_t i = observation.row_begin(v); i < observation.row_begin(v + 1); ++i) {
      const Window& w = windows[i];
      const int u = observation.column(i);
      farthest = std::max({farthest, u - w.u0, w.u1 - 1 - u, v - w.v0, w.v1 - 1 - v});
    }
  return farthest;
}

}  // namespace

Window ball_window(const Intrinsics& intrinsics, const Eigen::Vector3f& p, double delta) {
  const auto [u0, u1] =
      pixel_range(tangent_slopes(p.x(), p.z(), delta), intrinsics.fx, intrinsics.cx, intrinsics.width);
  const auto [v0, v1] =
      pixel_range(tangent_slopes(p.y(), p.z(), delta), intrinsics.fy, intrinsics.cy, intrinsics.height);
  return {u0, v0, u1, v1};
}

DeltaIndex::DeltaIndex(const Observation& observation, double delta, const Executor& executor,
                       const StopCondition& stop)
    : observation_(observation),
      delta_(delta),
      delta_squared_(static_cast<float>(delta) * static_cast<float>(delta)),
      windows_(ball_windows(observation, delta, executor, stop)),
      reach_(farthest_from_own_pixel(observation, windows_)),
      rows_(observation, reach_) {
  const Intrinsics& intrinsics = observation.intrinsics();
  // Balls a hair larger than delta, so that no point that passes the delta test in float is left out.
  const float radius = static_cast<float>(delta) + 4e-6F * std::max(1.0F, observation.farthest());
  if (!executor.for_each(
          static_cast<std::size_t>(intrinsics.height),
          [&](std::size_t row, std::size_t) {
            const int v = static_cast<int>(row);
            const std::size_t last = observation.row_begin(std::min(intrinsics.height, v + reach_ + 1));
            for (std::size_t i = observation.row_begin(std::max(0, v - reach_)); i < last; ++i) {
              const Window& w = windows_[i];
              if (v < w.v0 || v >= w.v1) continue;
              const Eigen::Vector3f& p = observation.points()[i];
              const BallRow ball{rows_.slopes(),
                                 rows_.nearest.data() + rows_.row(v),
                                 rows_.farthest.data() + rows_.row(v),
                                 rows_.slope_y[row],
                                 {p.x(), p.y(), p.z()},
                                 radius * radius,
                                 w.u0,
                                 w.u1};
              PERCH_CALL(take_in, ball);
            }
          },
          stop))
    throw Interrupted();
}

bool DeltaIndex::explained(int u, int v, float z) const {
  return !unexplained_throughout(u, v, z, 0.0F) && near_observed(u, v, z);
}

bool DeltaIndex::near_observed(int u, int v, float z) const {
  const Eigen::Vector3f p = observation_.rays().point(u, v, z);
  const auto test = [&](int column, int row) {
    const float depth = observation_.depth(column, row);
    return depth > 0.0F && within_delta(p, observation_.rays().point(column, row, depth), delta_squared_);
  };
  if (test(u, v)) return true;
  const Window window = ball_window(observation_.intrinsics(), p, delta_);
  // From the pixel's own row outwards: what explains it is nearly always close.
  for (int step = 0; v - step >= window.v0 || v + step < window.v1; ++step)
    for (const int row : {v - step, v + step}) {
      if (row < window.v0 || row >= window.v1) continue;
      for (int column = window.u0; column < window.u1; ++column)
        if (test(column, row)) return true;
      if (step == 0) break;
    }
  return false;
}

}  // namespace perch
