#include "perch/observation/pixel_rows.hpp"

#include <limits>

namespace perch {

PixelRows::PixelRows(const Observation& observation, int margin) {
  const int width = observation.intrinsics().width, height = observation.intrinsics().height;
  // What lies after one row lies before the next.
  before = static_cast<std::size_t>(margin) + lane_count;
  pitch = static_cast<std::size_t>(width) + before;
  const std::size_t size = before + pitch * static_cast<std::size_t>(height);
  slope_x.assign(before + pitch, 0.0F);
  for (int u = 0; u < width; ++u) slope_x[before + static_cast<std::size_t>(u)] = observation.rays().x(u);
  for (int v = 0; v < height; ++v) slope_y.push_back(observation.rays().y(v));
  depth.assign(size, 0.0F);
  number.assign(size, 0);
  nearest.assign(size, std::numeric_limits<float>::infinity());
  farthest.assign(size, -std::numeric_limits<float>::infinity());
  std::uint32_t next = 0;
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const std::size_t pixel = row(v) + static_cast<std::size_t>(u);
      depth[pixel] = observation.depth(u, v);
      number[pixel] = next;
      next += depth[pixel] > 0.0F;
    }
}

}  // namespace perch
