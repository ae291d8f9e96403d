#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "perch/core/image.hpp"
#include "perch/core/instruction_set.hpp"

namespace perch {

/// How far apart to sample a window, pixels, for about `samples` samples.
inline int sample_stride(const Window& window, int samples) {
  const double area = static_cast<double>(window.width()) * window.height();
  return std::max(1, static_cast<int>(std::sqrt(area / samples)));
}

/// Depths of a rendering at sampled pixels and their four neighbours: all that point-to-plane ICP asks of it.
/// Sample (i, j) lies at pixel (window.u0 + 1 + i stride, window.v0 + 1 + j stride).
struct DepthCrosses {
  enum Place { middle, left, right, up, down };

  Window window;  ///< that of the whole rendering
  int stride = 1;
  int columns = 0, rows = 0;
  std::vector<float> depth;  ///< lane_count of each sample, row-major; as in DepthPatch

  const float* at(int column, int row) const {
    return depth.data() + (static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                           static_cast<std::size_t>(column)) *
                              lane_count;
  }
};

}  // namespace perch
