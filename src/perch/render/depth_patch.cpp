#include "perch/render/depth_patch.hpp"

#include <algorithm>

namespace perch {

std::size_t DepthPatch::covered() const {
  return static_cast<std::size_t>(
      std::count_if(depth.begin(), depth.end(), [](float z) { return z < no_surface; }));
}

bool DepthPatch::any() const {
  return std::any_of(depth.begin(), depth.end(), [](float z) { return z < no_surface; });
}

DepthPatch compose(const std::vector<const DepthPatch*>& patches) {
  DepthPatch composite;
  for (const DepthPatch* patch : patches) composite.window = bounding(composite.window, patch->window);
  if (composite.window.empty()) return {};
  composite.depth.assign(static_cast<std::size_t>(composite.window.width()) *
                             static_cast<std::size_t>(composite.window.height()),
                         no_surface);
  for (const DepthPatch* patch : patches)
    for (int v = patch->window.v0; v < patch->window.v1; ++v) {
      const float* source = patch->row(v);
      float* target = composite.depth.data() + composite.index(patch->window.u0, v);
      for (int i = 0; i < patch->window.width(); ++i) target[i] = std::min(target[i], source[i]);
    }
  return composite;
}

}  // namespace perch
