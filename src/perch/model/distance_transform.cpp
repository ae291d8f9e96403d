#include "perch/model/distance_transform.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "perch/core/instruction_set.hpp"

namespace perch {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr int block_width = 2 * lane_count;  ///< columns worked on together

}  // namespace
}  // namespace perch

#define PERCH_KERNELS "perch/model/distance_transform.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {
namespace {

constexpr std::size_t columns_at_once = 512;  // of a task; their distances stay in the first cache

/// Squared distances along z, from 0 and infinity, for some columns of all planes: there and back.
void transform_columns(float* grid, std::size_t plane, std::size_t planes, std::size_t columns) {
  std::vector<float> distance(columns, infinity);
  for (std::size_t k = 0; k < planes; ++k) {
    float* row = grid + k * plane;
    for (std::size_t i = 0; i < columns; ++i) row[i] = distance[i] = std::min(row[i], distance[i] + 1.0F);
  }
  for (std::size_t k = planes; k-- > 0;) {
    float* row = grid + k * plane;
    for (std::size_t i = 0; i < columns; ++i) {
      distance[i] = std::min(row[i], distance[i] + 1.0F);
      row[i] = distance[i] * distance[i];
    }
  }
}

}  // namespace

void squared_distance_transform(std::vector<float>& grid, const Eigen::Vector3i& size,
                                const Executor& executor, const StopCondition& stop) {
  const auto width = static_cast<std::size_t>(size.x()), height = static_cast<std::size_t>(size.y()),
             planes = static_cast<std::size_t>(size.z()), plane = width * height;
  const auto for_each = [&](std::size_t n, const Executor::Body& body) {
    if (!executor.for_each(n, body, stop)) throw Interrupted();
  };
  for_each((plane + columns_at_once - 1) / columns_at_once, [&](std::size_t task, std::size_t) {
    const std::size_t first = task * columns_at_once;
    transform_columns(grid.data() + first, plane, planes, std::min(columns_at_once, plane - first));
  });

  const std::size_t pitch = (width + block_width - 1) / block_width * block_width + 2 * block_width;
  struct Scratch {
    std::vector<float> rows, columns;
  };
  std::vector<Scratch> scratch(executor.workers());
  for_each(planes, [&](std::size_t k, std::size_t worker) {
    auto& [rows, columns] = scratch[worker];
    rows.assign(pitch * height, infinity);
    columns.assign(pitch * height, infinity);
    for (std::size_t j = 0; j < height; ++j)
      std::copy_n(&grid[k * plane + j * width], width, &rows[j * pitch + block_width]);
    PERCH_CALL(transform_plane, rows.data(), columns.data(), size.x(), size.y(),
               static_cast<std::ptrdiff_t>(pitch));
    for (std::size_t j = 0; j < height; ++j)
      std::copy_n(&rows[j * pitch + block_width], width, &grid[k * plane + j * width]);
  });
}

}  // namespace perch
