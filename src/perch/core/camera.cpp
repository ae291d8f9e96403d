#include "perch/core/camera.hpp"

#include <fmt/format.h>

#include <cmath>

#include "perch/core/error.hpp"

namespace perch {

void Intrinsics::check() const {
  static constexpr int largest = 16384;
  const auto size = [](const char* name, int value) {
    if (value < 1 || value > largest)
      throw InvalidSetting(
          fmt::format("intrinsics.{} is {}; it must lie between 1 and {} pixels", name, value, largest));
  };
  size("width", width);
  size("height", height);
  const auto focal = [](const char* name, double value) {
    if (!std::isfinite(value) || value <= 0.0)
      throw InvalidSetting(
          fmt::format("intrinsics.{} is {}; a focal length must be finite and > 0 (pixels)", name, value));
  };
  focal("fx", fx);
  focal("fy", fy);
  const auto centre = [](const char* name, double value) {
    if (!std::isfinite(value))
      throw InvalidSetting(fmt::format("intrinsics.{} is {}; it must be finite", name, value));
  };
  centre("cx", cx);
  centre("cy", cy);
}

RaySlopes::RaySlopes(const Intrinsics& intrinsics)
    : x_(static_cast<std::size_t>(intrinsics.width)), y_(static_cast<std::size_t>(intrinsics.height)) {
  for (std::size_t u = 0; u < x_.size(); ++u)
    x_[u] = static_cast<float>((static_cast<double>(u) - intrinsics.cx) / intrinsics.fx);
  for (std::size_t v = 0; v < y_.size(); ++v)
    y_[v] = static_cast<float>((static_cast<double>(v) - intrinsics.cy) / intrinsics.fy);
}

}  // namespace perch
