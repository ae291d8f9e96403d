#include "perch/observation/observation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "perch/core/error.hpp"

namespace perch {

Observation::Observation(const Camera& camera, const DepthImage& depth,
                         const std::optional<Image<std::uint8_t>>& mask)
    : camera_(camera),
      rays_(camera.intrinsics),
      states_(depth.width(), depth.height(), PixelState::free),
      depth_(depth.width(), depth.height(), 0.0F),
      readings_(depth_) {
  const int width = camera.intrinsics.width, height = camera.intrinsics.height;
  if (depth.width() != width || depth.height() != height ||
      (mask && (mask->width() != width || mask->height() != height)))
    throw std::logic_error("Observation: image sizes differ from the intrinsics");
  row_begin_.reserve(static_cast<std::size_t>(height) + 1);
  for (int v = 0; v < height; ++v) {
    row_begin_.push_back(points_.size());
    for (int u = 0; u < width; ++u) {
      const float z = depth(u, v);
      if (!(z > 0.0F) || !std::isfinite(z)) {
        if (mask) states_(u, v) = PixelState::unknown;
        continue;
      }
      readings_(u, v) = z;
      if (mask && (*mask)(u, v) == 0) continue;
      states_(u, v) = PixelState::object;
      depth_(u, v) = z;
      points_.push_back(rays_.point(u, v, z));
      columns_.push_back(u);
      window_ = bounding(window_, {u, v, u + 1, v + 1});
    }
  }
  row_begin_.push_back(points_.size());
  if (points_.empty())
    throw InputError(mask
                         ? "no observed points: no pixel has both a depth reading and a non-zero mask; check "
                           "observation.mask and observation.depth"
                         : "no observed points: no pixel has a depth reading; check observation.depth");
  const auto [near, far] = std::minmax_element(points_.begin(), points_.end(),
                                               [](const auto& a, const auto& b) { return a.z() < b.z(); });
  nearest_ = near->z();
  farthest_ = far->z();
}

}  // namespace perch
