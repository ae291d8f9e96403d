#include "perch/observation/delta_index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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
      windows_(observation.size()),
      rows_(observation) {
  const Intrinsics& intrinsics = observation.intrinsics();
  if (!executor.for_each(
          static_cast<std::size_t>(intrinsics.height),
          [&](std::size_t row, std::size_t) {
            const int v = static_cast<int>(row);
            for (std::size_t i = observation.row_begin(v); i < observation.row_begin(v + 1); ++i)
              windows_[i] = ball_window(intrinsics, observation.points()[i], delta);
          },
          stop))
    throw Interrupted();
  for (int v = 0; v < intrinsics.height; ++v)
    for (std::size_t i = observation.row_begin(v); i < observation.row_begin(v + 1); ++i) {
      const Window& w = windows_[i];
      covered_ = bounding(covered_, w);
      const int u = observation.column(i);
      reach_ = std::max({reach_, u - w.u0, w.u1 - 1 - u, v - w.v0, w.v1 - 1 - v});
    }

  // Balls a hair larger than delta, so that no point that passes the delta test in float is left out.
  const double radius = delta + 2e-6 * std::max(1.0F, observation.farthest());
  const std::size_t columns = static_cast<std::size_t>(covered_.width());
  struct Row {
    std::vector<std::uint32_t> counts;
    std::vector<Interval> intervals;
  };
  std::vector<Row> rows(static_cast<std::size_t>(covered_.height()));
  if (!executor.for_each(
          rows.size(),
          [&](std::size_t row, std::size_t) {
            const int v = covered_.v0 + static_cast<int>(row);
            std::vector<std::vector<Interval>> pixels(columns);
            const int first_row = std::max(0, v - reach_),
                      last_row = std::min(intrinsics.height - 1, v + reach_);
            for (std::size_t i = observation.row_begin(first_row); i < observation.row_begin(last_row + 1);
                 ++i) {
              const Window& w = windows_[i];
              if (v < w.v0 || v >= w.v1) continue;
              const Eigen::Vector3d p = observation.points()[i].cast<double>();
              const double y = observation.rays().y(v);
              for (int u = w.u0; u < w.u1; ++u) {
                // |z d - p|^2 <= radius^2 for d = (x, y, 1), in the form that does not cancel.
                const Eigen::Vector3d d(observation.rays().x(u), y, 1.0);
                const double length_squared = d.squaredNorm();
                const double discriminant = length_squared * radius * radius - d.cross(p).squaredNorm();
                if (discriminant < 0.0) continue;
                const double middle = d.dot(p) / length_squared,
                             half = std::sqrt(discriminant) / length_squared;
                Interval added{static_cast<float>(middle - half), static_cast<float>(middle + half)};
                auto& list = pixels[static_cast<std::size_t>(u - covered_.u0)];
                // Keep the list sorted and disjoint; nearly always there is one interval, and this one widens
                // it.
                const auto overlaps_from = std::find_if(
                    list.begin(), list.end(), [&](const Interval& other) { return other.high >= added.low; });
                auto overlaps_to = overlaps_from;
                while (overlaps_to != list.end() && overlaps_to->low <= added.high) {
                  added.low = std::min(added.low, overlaps_to->low);
                  added.high = std::max(added.high, overlaps_to->high);
                  ++overlaps_to;
                }
                if (overlaps_from == overlaps_to) {
                  list.insert(overlaps_from, added);
                } else {
                  *overlaps_from = added;
                  list.erase(overlaps_from + 1, overlaps_to);
                }
              }
            }
            for (const auto& list : pixels) {
              rows[row].counts.push_back(static_cast<std::uint32_t>(list.size()));
              rows[row].intervals.insert(rows[row].intervals.end(), list.begin(), list.end());
            }
          },
          stop))
    throw Interrupted();
  first_.reserve(rows.size() * columns + 1);
  first_.push_back(0);
  for (const Row& row : rows) {
    for (const std::uint32_t count : row.counts) first_.push_back(first_.back() + count);
    intervals_.insert(intervals_.end(), row.intervals.begin(), row.intervals.end());
  }
  for (int v = covered_.v0; v < covered_.v1; ++v)
    for (int u = covered_.u0; u < covered_.u1; ++u) {
      const std::size_t pixel = rows_.row(v) + static_cast<std::size_t>(u);
      if (const Interval* first = interval_from(u, v, 0.0F)) {
        rows_.first_low[pixel] = first->low;
        rows_.last_high[pixel] = intervals_[first_[pixel_number(u, v) + 1] - 1].high;
      }
    }
}

const DeltaIndex::Interval* DeltaIndex::interval_from(int u, int v, float z) const {
  if (!covered_.contains(u, v)) return nullptr;
  const std::size_t pixel = pixel_number(u, v);
  for (std::uint32_t i = first_[pixel]; i < first_[pixel + 1]; ++i)
    if (intervals_[i].high >= z) return &intervals_[i];
  return nullptr;
}

bool DeltaIndex::explained(int u, int v, float z) const {
  return may_be_explained(u, v, z) && near_observed(u, v, z);
}

bool DeltaIndex::unexplained_throughout(int u, int v, float z, float reach) const {
  const Interval* interval = interval_from(u, v, z - reach);
  return interval == nullptr || interval->low > z;
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
