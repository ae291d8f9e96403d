#pragma once

#include <limits>
#include <vector>

#include "perch/core/image.hpp"

namespace perch {

/// The depth at which a pixel shows nothing.
inline constexpr float no_surface = std::numeric_limits<float>::infinity();

/// Depth of one object (or of a composite) inside a window of the image: metres along the optical axis,
/// no_surface where nothing is rendered; row-major within the window.
struct DepthPatch {
  Window window;
  std::vector<float> depth;

  float at(int u, int v) const { return depth[index(u, v)]; }
  /// The same for any pixel of the image.
  float at_or_none(int u, int v) const { return window.contains(u, v) ? at(u, v) : no_surface; }
  const float* row(int v) const { return depth.data() + index(window.u0, v); }
  float* row(int v) { return depth.data() + index(window.u0, v); }
  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v - window.v0) * static_cast<std::size_t>(window.width()) +
           static_cast<std::size_t>(u - window.u0);
  }
  /// Number of pixels that show a surface.
  std::size_t covered() const;
  bool any() const;
};

/// The nearest surface of all the patches, in the smallest window that holds them.
DepthPatch compose(const std::vector<const DepthPatch*>& patches);

}  // namespace perch
