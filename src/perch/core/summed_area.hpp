#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "perch/core/image.hpp"

namespace perch {

/// Sums of pixels' values over any window by four look-ups (Crow 1984).
class SummedArea {
 public:
  SummedArea() = default;
  /// \param window outside of it all values are 0. \param value of pixel (u, v).
  template <typename Value>
  SummedArea(const Window& window, Value value)
      : window_(window.empty() ? Window() : window),
        pitch_(static_cast<std::size_t>(window_.width()) + 1),
        sums_(pitch_ * (static_cast<std::size_t>(window_.height()) + 1), 0) {
    for (int v = window_.v0; v < window_.v1; ++v)
      for (int u = window_.u0; u < window_.u1; ++u)
        sums_[at(u + 1, v + 1)] =
            sums_[at(u, v + 1)] + sums_[at(u + 1, v)] - sums_[at(u, v)] + std::int64_t{value(u, v)};
  }

  std::int64_t operator()(const Window& window) const {
    const Window w = intersection(window, window_);
    if (w.empty()) return 0;
    return sums_[at(w.u1, w.v1)] - sums_[at(w.u0, w.v1)] - sums_[at(w.u1, w.v0)] + sums_[at(w.u0, w.v0)];
  }

 private:
  std::size_t at(int u, int v) const {
    return static_cast<std::size_t>(v - window_.v0) * pitch_ + static_cast<std::size_t>(u - window_.u0);
  }

  Window window_;
  std::size_t pitch_ = 1;
  std::vector<std::int64_t> sums_;  ///< of the values above and left of a corner
};

}  // namespace perch
