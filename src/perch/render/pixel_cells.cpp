#include "perch/render/pixel_cells.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace perch {
namespace {

static_assert(PixelCells::cell_width * PixelCells::cell_height == lane_count);

/// Where the pixels of a cell lie from its place.
constexpr std::array<int, lane_count> right{0, 1, 2, 3, 0, 1, 2, 3}, down{0, 0, 0, 0, 1, 1, 1, 1};

void fill_axis(const std::array<int, lane_count>& offsets, int cells, int origin, int step,
               const std::vector<float>& rays, std::vector<float>& place, std::vector<float>& slope) {
  place.resize(static_cast<std::size_t>(cells) * lane_count);
  slope.resize(place.size());
  const int last = static_cast<int>(rays.size()) - 1;
  std::size_t i = 0;
  for (int cell = 0; cell < cells; ++cell)
    for (const int offset : offsets) {
      const int pixel = origin + cell * step + offset;
      place[i] = static_cast<float>(pixel);
      slope[i] = rays[static_cast<std::size_t>(std::clamp(pixel, 0, last))];
      ++i;
    }
}

}  // namespace

void PixelCells::lay_out(const Window& over, const std::vector<float>& ray_x,
                         const std::vector<float>& ray_y) {
  window = over;
  columns = (window.width() + cell_width - 1) / cell_width;
  rows = (window.height() + cell_height - 1) / cell_height;
  fill_axis(right, columns, window.u0, cell_width, ray_x, u, slope_x);
  fill_axis(down, rows, window.v0, cell_height, ray_y, v, slope_y);
  inverse_depth.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) * lane_count, 0.0F);
}

}  // namespace perch
