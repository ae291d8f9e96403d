#include "picture_panels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "picture_shading.hpp"

namespace perch::app {
namespace {

constexpr Rgb explained_color{150, 152, 156};
constexpr Rgb observed_color{230, 85, 0};    // unexplained observed points
constexpr Rgb rendered_color{70, 175, 245};  // unexplained rendered points
constexpr Rgb both_color{250, 232, 80};
constexpr Rgb left_out_color{60, 60, 72};
constexpr Rgb ground_color{120, 122, 128};  // readings of nothing of interest, before they are dimmed
constexpr float ground_dim = 0.28F;

bool is_observed(const Scene& scene, int u, int v) {
  return scene.depth(u, v) > 0.0F && (!scene.mask || (*scene.mask)(u, v) != 0);
}

/// The observed points and the rendered ones with a margin, cut to the image.
Window window_of_interest(const Scene& scene, const SceneRendering* rendering) {
  Window window;
  for (int v = 0; v < scene.depth.height(); ++v)
    for (int u = 0; u < scene.depth.width(); ++u)
      if (is_observed(scene, u, v) || (rendering && rendering->object_at(u, v)))
        window = bounding(window, {u, v, u + 1, v + 1});
  const Window image = scene.camera.intrinsics.window();
  if (window.empty()) return image;
  const int margin = std::max(4, std::max(window.width(), window.height()) / 16);
  return intersection({window.u0 - margin, window.v0 - margin, window.u1 + margin, window.v1 + margin},
                      image);
}

/// Makes the images of the panels; holds what more than one of them needs.
class Painter {
 public:
  Painter(const Scene& scene, const SceneRendering* rendering)
      : scene_(scene),
        rendering_(rendering),
        window_(window_of_interest(scene, rendering)),
        observed_light_(shading(scene.depth, scene.camera.intrinsics, window_, 2)) {
    if (rendering_) rendered_light_ = shading(rendering_->depth, scene.camera.intrinsics, window_, 0);
    std::vector<float> depths;
    each([&](int u, int v) {
      if (is_observed(scene_, u, v)) depths.push_back(scene_.depth(u, v));
    });
    range_ = depth_range(std::move(depths));
  }

  const Window& window() const { return window_; }

  Image<std::uint32_t> objects() const {
    Image<std::uint32_t> objects(window_.width(), window_.height());
    each([&](int u, int v) { objects(u - window_.u0, v - window_.v0) = rendering_->object(u, v); });
    return objects;
  }

  Panel color() const {
    return {"color image", paint([&](int u, int v) { return (*scene_.color)(u, v); }), false, {}};
  }

  Panel observed(std::int64_t points) const {
    bool ground = false;
    each([&](int u, int v) { ground = ground || (scene_.depth(u, v) > 0 && !is_observed(scene_, u, v)); });
    Panel panel{"observed",
                paint([&](int u, int v) {
                  if (!is_observed(scene_, u, v)) return ground_at(u, v);
                  return scaled(depth_color(range_.place(scene_.depth(u, v))), observed_light(u, v));
                }),
                false,
                {}};
    panel.legend.push_back(depth_legend());
    panel.legend.push_back({{}, fmt::format("{} observed points", grouped(points))});
    if (ground) panel.legend.push_back({{scaled(ground_color, ground_dim)}, "not of interest"});
    return panel;
  }

  Panel rendered(std::size_t objects) const {
    std::int64_t points = 0;
    each([&](int u, int v) { points += rendering_->object_at(u, v).has_value(); });
    Panel panel{"rendered",
                paint([&](int u, int v) {
                  const auto object = rendering_->object_at(u, v);
                  if (!object) return panel_background;
                  const float far = range_.place(rendering_->depth(u, v));
                  return scaled(object_color(*object), rendered_light(u, v) * (1.1F - 0.3F * far));
                }),
                true,
                {}};
    panel.legend.push_back(
        {{},
         fmt::format("{} object{}, {} rendered points", grouped(static_cast<std::int64_t>(objects)),
                     objects == 1 ? "" : "s", grouped(points))});
    return panel;
  }

  Panel residual() const {
    std::int64_t both = 0, left_out = 0;
    each([&](int u, int v) {
      both += rendering_->observed_unexplained(u, v) && rendering_->rendered_unexplained(u, v);
      left_out += rendering_->left_out(u, v);
    });
    Panel panel{"residual", paint([&](int u, int v) { return residual_at(u, v); }), true, {}};
    panel.legend.push_back({{observed_color},
                            fmt::format("{} observed, not explained by the rendering",
                                        grouped(rendering_->cost.cost_observed))});
    panel.legend.push_back({{rendered_color},
                            fmt::format("{} rendered, not explained by the observation",
                                        grouped(rendering_->cost.cost_rendered))});
    panel.legend.push_back({{scaled(explained_color, 0.8F)}, "explained"});
    if (both > 0)
      panel.legend.push_back(
          {{both_color}, fmt::format("{} pixel{} where both hold", grouped(both), both == 1 ? "" : "s")});
    if (left_out > 0)
      panel.legend.push_back(
          {{left_out_color}, fmt::format("{} without a reading, not counted", grouped(left_out))});
    return panel;
  }

 private:
  template <typename Visit>
  void each(Visit visit) const {
    for (int v = window_.v0; v < window_.v1; ++v)
      for (int u = window_.u0; u < window_.u1; ++u) visit(u, v);
  }
  template <typename ColorOf>
  Image<Rgb> paint(ColorOf color_of) const {
    Image<Rgb> image(window_.width(), window_.height());
    each([&](int u, int v) { image(u - window_.u0, v - window_.v0) = color_of(u, v); });
    return image;
  }
  float observed_light(int u, int v) const { return observed_light_(u - window_.u0, v - window_.v0); }
  float rendered_light(int u, int v) const { return rendered_light_(u - window_.u0, v - window_.v0); }

  LegendEntry depth_legend() const {
    const std::string near = fmt::format("{:.2f}", range_.near), far = fmt::format("{:.2f}", range_.far);
    if (near == far) return {{depth_color(0.0F)}, fmt::format("depth {} m", near)};
    constexpr int steps = 45;
    LegendEntry entry{{}, fmt::format("depth {} to {} m", near, far)};
    for (int i = 0; i < steps; ++i)
      entry.swatch.push_back(depth_color(static_cast<float>(i) / static_cast<float>(steps - 1)));
    return entry;
  }
  Rgb ground_at(int u, int v) const {
    return scene_.depth(u, v) > 0.0F ? scaled(ground_color, ground_dim * observed_light(u, v))
                                     : panel_background;
  }
  Rgb residual_at(int u, int v) const {
    const bool observed = rendering_->observed_unexplained(u, v) != 0;
    const bool rendered = rendering_->rendered_unexplained(u, v) != 0;
    if (observed || rendered) {
      const float light = rendered ? rendered_light(u, v) : observed_light(u, v);
      // Nearly flat: what is wrong must stand out, its shape only show through.
      return scaled(observed && rendered ? both_color
                    : observed           ? observed_color
                                         : rendered_color,
                    0.7F + 0.3F * light);
    }
    if (rendering_->observed(u, v)) return scaled(explained_color, 0.9F * observed_light(u, v));
    if (rendering_->left_out(u, v)) return left_out_color;
    if (rendering_->object_at(u, v)) return scaled(explained_color, 0.9F * rendered_light(u, v));
    return ground_at(u, v);
  }

  const Scene& scene_;
  const SceneRendering* rendering_;
  Window window_;
  Image<float> observed_light_, rendered_light_;
  DepthRange range_;
};

/// The edges between pixels that show different objects; neighbours in a row or column in one piece.
std::vector<Segment> outlines_of(const SceneRendering& rendering, const Window& window) {
  std::vector<Segment> segments;
  const auto object = [&](int u, int v) {
    return window.contains(u, v) ? rendering.object(u, v) : SceneRendering::no_object;
  };
  for (int v = window.v0; v <= window.v1; ++v)
    for (int u = window.u0; u < window.u1; ++u) {
      const int first = u;
      while (u < window.u1 && object(u, v) != object(u, v - 1)) ++u;
      if (u > first) segments.push_back({first - window.u0, v - window.v0, u - window.u0, v - window.v0});
    }
  for (int u = window.u0; u <= window.u1; ++u)
    for (int v = window.v0; v < window.v1; ++v) {
      const int first = v;
      while (v < window.v1 && object(u, v) != object(u - 1, v)) ++v;
      if (v > first) segments.push_back({u - window.u0, first - window.v0, u - window.u0, v - window.v0});
    }
  return segments;
}

/// "mug 1" and "mug 2" where there are two mugs, else "mug".
std::vector<ObjectName> names_of(const Result& result) {
  constexpr std::size_t longest = 28;
  std::map<std::string, int> copies, met;
  for (const ObjectResult& object : result.objects) ++copies[object.model];
  std::vector<ObjectName> names;
  for (const ObjectResult& object : result.objects) {
    ObjectName name;
    name.text = printable(object.model, longest);
    if (copies[object.model] > 1) name.text += fmt::format(" {}", ++met[object.model]);
    names.push_back(std::move(name));
  }
  return names;
}

/// Finds for each name the visible pixel nearest to the middle of its object's visible pixels.
void locate(const SceneRendering& rendering, const Window& window, std::vector<ObjectName>& names) {
  const auto each = [&](auto visit) {
    for (int v = window.v0; v < window.v1; ++v)
      for (int u = window.u0; u < window.u1; ++u)
        if (const auto object = rendering.object_at(u, v))
          visit(*object, u - window.u0 + 0.5, v - window.v0 + 0.5);
  };
  std::vector<std::array<double, 2>> sums(names.size(), {0.0, 0.0});
  each([&](std::size_t i, double u, double v) {
    ++names[i].visible;
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    names[i].seen = bounding(names[i].seen, {column, row, column + 1, row + 1});
    sums[i][0] += u;
    sums[i][1] += v;
  });
  std::vector<double> nearest(names.size(), std::numeric_limits<double>::infinity());
  each([&](std::size_t i, double u, double v) {
    const auto n = static_cast<double>(names[i].visible);
    const double distance = std::hypot(u - sums[i][0] / n, v - sums[i][1] / n);
    if (distance >= nearest[i]) return;
    nearest[i] = distance;
    names[i].u = u;
    names[i].v = v;
  });
}

}  // namespace

std::string grouped(std::int64_t count) {
  std::string digits = fmt::format("{}", count);
  const std::size_t first = digits[0] == '-' ? 1 : 0;
  for (std::size_t i = digits.size(); i > first + 3;) digits.insert(i -= 3, 1, ',');
  return digits;
}

Panels make_panels(const Scene& scene, const Result& result, const SceneRendering* rendering) {
  const Painter painter(scene, rendering);
  Panels panels;
  if (scene.color) panels.panels.push_back(painter.color());
  panels.panels.push_back(painter.observed(result.observed_points));
  if (!rendering) return panels;
  panels.panels.push_back(painter.rendered(result.objects.size()));
  panels.panels.push_back(painter.residual());
  panels.outlines = outlines_of(*rendering, painter.window());
  panels.names = names_of(result);
  panels.objects = painter.objects();
  locate(*rendering, painter.window(), panels.names);
  return panels;
}

}  // namespace perch::app
