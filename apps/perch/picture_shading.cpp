#include "picture_shading.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace perch::app {
namespace {

/// Neighbours whose depths differ by more than this share of it lie on different surfaces.
constexpr float surface_step = 0.02F;

bool same_surface(float a, float b) {
  return a > 0.0F && b > 0.0F && std::abs(a - b) <= surface_step * std::min(a, b);
}

/// The window of a depth image, each depth averaged with its surface around it.
DepthImage smoothed(const DepthImage& depth, const Window& window, int radius) {
  DepthImage out(window.width(), window.height());
  for (int v = window.v0; v < window.v1; ++v)
    for (int u = window.u0; u < window.u1; ++u) {
      const float z = depth(u, v);
      if (!(z > 0.0F)) continue;
      float sum = 0.0F;
      int count = 0;
      for (int y = std::max(0, v - radius); y <= std::min(depth.height() - 1, v + radius); ++y)
        for (int x = std::max(0, u - radius); x <= std::min(depth.width() - 1, u + radius); ++x)
          if (same_surface(depth(x, y), z)) {
            sum += depth(x, y);
            ++count;
          }
      out(u - window.u0, v - window.v0) = count > 0 ? sum / static_cast<float>(count) : z;
    }
  return out;
}

}  // namespace

Image<float> shading(const DepthImage& depth, const Intrinsics& intrinsics, const Window& window,
                     int smoothing) {
  const DepthImage z = smoothed(depth, window, smoothing);
  const RaySlopes rays(intrinsics);
  const auto point = [&](int u, int v) { return rays.point(u + window.u0, v + window.v0, z(u, v)); };
  const int step = 1 + smoothing / 2;
  const Eigen::Vector3f to_light = Eigen::Vector3f(-0.45F, -0.7F, -1.0F).normalized();
  Image<float> light(window.width(), window.height(), 0.75F);
  for (int v = 0; v < z.height(); ++v)
    for (int u = 0; u < z.width(); ++u) {
      if (!(z(u, v) > 0.0F)) continue;
      // Along a direction, from the neighbour on one side to that on the other; at an edge, from the pixel.
      const auto along = [&](int du, int dv) -> Eigen::Vector3f {
        const auto on_surface = [&](int x, int y) {
          return z.contains(x, y) && same_surface(z(x, y), z(u, v));
        };
        const bool after = on_surface(u + du, v + dv), before = on_surface(u - du, v - dv);
        if (!after && !before) return Eigen::Vector3f::Zero();
        const Eigen::Vector3f to = after ? point(u + du, v + dv) : point(u, v);
        const Eigen::Vector3f from = before ? point(u - du, v - dv) : point(u, v);
        return to - from;
      };
      Eigen::Vector3f normal = along(step, 0).cross(along(0, step));
      if (!(normal.norm() > 0.0F)) continue;
      normal.normalize();
      if (normal.dot(point(u, v)) > 0.0F) normal = -normal;
      light(u, v) = 0.38F + 0.62F * std::max(0.0F, normal.dot(to_light));
    }
  return light;
}

float DepthRange::place(float depth) const {
  return far > near ? std::clamp((depth - near) / (far - near), 0.0F, 1.0F) : 0.0F;
}

DepthRange depth_range(std::vector<float> depths) {
  if (depths.empty()) return {};
  const auto at = [&](double share) {
    const auto place =
        depths.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(depths.size() - 1));
    std::nth_element(depths.begin(), place, depths.end());
    return *place;
  };
  const float near = at(0.01);
  return {near, at(0.99)};
}

Rgb scaled(Rgb color, float factor) {
  const auto channel = [&](std::uint8_t c) {
    return static_cast<std::uint8_t>(std::clamp(std::round(static_cast<float>(c) * factor), 0.0F, 255.0F));
  };
  return {channel(color.r), channel(color.g), channel(color.b)};
}

Rgb mixed(Rgb a, Rgb b, float share_of_b) {
  const auto channel = [&](std::uint8_t x, std::uint8_t y) {
    return static_cast<std::uint8_t>(
        std::round(static_cast<float>(x) * (1.0F - share_of_b) + static_cast<float>(y) * share_of_b));
  };
  return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b)};
}

Rgb depth_color(float t) {
  static constexpr std::array<Rgb, 7> stops{{{253, 231, 37},
                                             {144, 215, 67},
                                             {53, 183, 121},
                                             {33, 145, 140},
                                             {49, 104, 142},
                                             {68, 75, 150},
                                             {92, 58, 148}}};
  const float place = std::clamp(t, 0.0F, 1.0F) * static_cast<float>(stops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(place), stops.size() - 2);
  return mixed(stops[i], stops[i + 1], place - static_cast<float>(i));
}

Rgb object_color(std::size_t object) {
  static constexpr std::array<Rgb, 8> colors{{{86, 180, 233},
                                              {230, 159, 0},
                                              {0, 158, 115},
                                              {204, 121, 167},
                                              {240, 228, 66},
                                              {70, 110, 220},
                                              {213, 94, 0},
                                              {190, 190, 190}}};
  const Rgb color = colors[object % colors.size()];
  switch (object / colors.size() % 3) {
    case 0:
      return color;
    case 1:
      return mixed(color, {255, 255, 255}, 0.45F);
    default:
      return scaled(color, 0.65F);
  }
}

}  // namespace perch::app
