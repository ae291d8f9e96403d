#include "inspect_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "perch/observation/extent.hpp"
#include "perch/render/rasterizer.hpp"
#include "picture_canvas.hpp"
#include "picture_panels.hpp"
#include "picture_shading.hpp"

namespace perch::app {
namespace {

constexpr double outer_edge = 24, panel_gap = 20, panel_title_height = 30, warning_line = 22,
                 panel_width = 620;
constexpr Rgb text_ink{25, 28, 33}, warning_ink{190, 40, 20}, plane_color{70, 140, 90},
    reading_color{105, 108, 114}, workspace_color{250, 232, 80};
constexpr Font panel_font{18, true}, warning_font{14, false}, model_font{14, true};

class InspectionPicture {
 public:
  InspectionPicture(const Scene& raw, const Scene& scene, const Inspection& found)
      : raw_(raw),
        scene_(scene),
        found_(found),
        k_(scene.camera.intrinsics),
        scale_(panel_width / k_.width),
        light_(shading(raw.depth, k_, k_.window(), 2)) {}

  std::string png() {
    const double height = std::max(1.0, std::round(k_.height * scale_));
    const double width = 2 * outer_edge + 3 * panel_width + 2 * panel_gap;
    Canvas measure(1, 1);
    std::vector<std::string> lines;
    for (const Warning& warning : found_.warnings)
      for (std::string& line : measure.wrapped(
               printable("WARNING: " + warning.key + " " + warning.what + "; " + warning.remedy, 400),
               warning_font, width - 2 * outer_edge))
        lines.push_back(std::move(line));
    if (lines.empty()) lines.push_back("nothing looks wrong");
    const double top = outer_edge + panel_title_height, foot = top + height + 20;
    Canvas canvas(static_cast<int>(width),
                  static_cast<int>(foot + warning_line * static_cast<double>(lines.size() + 1) + outer_edge));
    const auto box = [&](int i) {
      return Box{outer_edge + i * (panel_width + panel_gap), top, panel_width, height};
    };
    draw_panel(canvas, box(0), "depth; grey: not the objects'", depth_image());
    draw_panel(canvas, box(1), "plane (green) and workspace (yellow)", plane_image());
    draw_workspace(canvas, box(1));
    std::vector<std::pair<Eigen::Vector2d, std::string>> names;
    draw_panel(canvas, box(2), "each model once, as the camera would see it", model_image(names));
    draw_workspace(canvas, box(2));
    for (const auto& [at, name] : names)
      canvas.rimmed_text(box(2).x + at.x() * scale_ - 0.5 * canvas.text_width(name, model_font),
                         box(2).y + at.y() * scale_, name, model_font, {255, 255, 255}, panel_background);
    double y = foot;
    for (const std::string& line : lines)
      canvas.text(outer_edge, y += warning_line, line, warning_font,
                  found_.warnings.empty() ? text_ink : warning_ink);
    return canvas.png();
  }

 private:
  static void draw_panel(Canvas& canvas, const Box& box, const std::string& name, const Image<Rgb>& image) {
    canvas.text(box.x, box.y - 10, name, panel_font, text_ink);
    canvas.fill(box, panel_background);
    canvas.draw(image, box);
  }

  template <typename ColorOf>
  Image<Rgb> painted(const ColorOf& color_of) const {
    Image<Rgb> image(k_.width, k_.height, panel_background);
    for (int v = 0; v < k_.height; ++v)
      for (int u = 0; u < k_.width; ++u)
        if (raw_.depth(u, v) > 0.0F) image(u, v) = scaled(color_of(u, v), light_(u, v));
    return image;
  }

  Image<Rgb> depth_image() const {
    const auto observed = [&](int u, int v) {
      return scene_.depth(u, v) > 0.0F && (!scene_.mask || (*scene_.mask)(u, v) != 0);
    };
    std::vector<float> depths;
    for (int v = 0; v < k_.height; ++v)
      for (int u = 0; u < k_.width; ++u)
        if (observed(u, v)) depths.push_back(scene_.depth(u, v));
    const DepthRange range = depth_range(std::move(depths));
    return painted([&](int u, int v) {
      return observed(u, v) ? depth_color(range.place(raw_.depth(u, v))) : scaled(reading_color, 0.55F);
    });
  }

  Image<Rgb> plane_image() const {
    const RaySlopes rays(k_);
    constexpr double on_plane = 0.01;
    return painted([&](int u, int v) {
      if (!found_.plane) return reading_color;
      const Eigen::Vector3d p = rays.point(u, v, raw_.depth(u, v)).cast<double>();
      const double above = found_.plane->normal.dot(p) + found_.plane->distance;
      return std::abs(above) < on_plane ? plane_color
             : above < 0.0              ? scaled(reading_color, 0.5F)
                                        : Rgb{170, 172, 178};
    });
  }

  /// Where a point of the world is seen, pixels; empty behind the camera.
  std::optional<Eigen::Vector2d> seen_at(const Eigen::Vector3d& world) const {
    const Eigen::Vector3d p = scene_.camera.world_from_camera.inverse() * world;
    if (p.z() < 0.05) return std::nullopt;
    return Eigen::Vector2d(k_.fx * p.x() / p.z() + k_.cx, k_.fy * p.y() / p.z() + k_.cy);
  }

  double height() const { return found_.table_height.value_or(scene_.table_height.value_or(0.0)); }

  Workspace workspace() const {
    if (scene_.workspace) return *scene_.workspace;
    try {
      const Eigen::AlignedBox2d seen = footprint(Observation(scene_.camera, scene_.depth, scene_.mask));
      return {seen.min().x(), seen.max().x(), seen.min().y(), seen.max().y()};
    } catch (const std::exception&) {  // nothing observed
      return {-0.1, 0.1, -0.1, 0.1};
    }
  }

  void draw_workspace(Canvas& canvas, const Box& box) const {
    const Workspace w = workspace();
    const Eigen::Vector3d corners[4]{{w.x_min, w.y_min, height()},
                                     {w.x_max, w.y_min, height()},
                                     {w.x_max, w.y_max, height()},
                                     {w.x_min, w.y_max, height()}};
    constexpr int steps = 32;
    for (int side = 0; side < 4; ++side)
      for (int i = 0; i < steps; ++i) {
        const auto on_side = [&](int n) {
          return seen_at(corners[side] + (corners[(side + 1) % 4] - corners[side]) * n / steps);
        };
        const auto a = on_side(i), b = on_side(i + 1);
        if (!a || !b || !in_image(*a) || !in_image(*b)) continue;
        canvas.line(box.x + a->x() * scale_, box.y + a->y() * scale_, box.x + b->x() * scale_,
                    box.y + b->y() * scale_, 2.0, workspace_color);
      }
  }

  bool in_image(const Eigen::Vector2d& at) const {
    return at.x() >= 0 && at.y() >= 0 && at.x() < k_.width && at.y() < k_.height;
  }

  /// The models side by side along the workspace's longer side.
  Image<Rgb> model_image(std::vector<std::pair<Eigen::Vector2d, std::string>>& names) const {
    const Workspace w = workspace();
    const Eigen::Vector2d low(w.x_min, w.y_min), high(w.x_max, w.y_max), middle = 0.5 * (low + high);
    const bool along_x = high.x() - low.x() >= high.y() - low.y();
    DepthImage depth(k_.width, k_.height, 0.0F);
    Image<std::uint32_t> of(k_.width, k_.height, 0);
    Rasterizer rasterizer(k_);
    const std::size_t n = scene_.models.size();
    for (std::size_t i = 0; i < n; ++i) {
      const SceneModel& model = scene_.models[i];
      const double t = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
      const Eigen::Vector2d at = along_x ? Eigen::Vector2d(low.x() + t * (high.x() - low.x()), middle.y())
                                         : Eigen::Vector2d(middle.x(), low.y() + t * (high.y() - low.y()));
      const Eigen::Isometry3d world_from_model =
          perch::world_from_model({at.x(), at.y(), 0.0}, height() + model.base);
      const DepthPatch patch =
          rasterizer.render(model.mesh, scene_.camera.world_from_camera.inverse() * world_from_model);
      for (int v = patch.window.v0; v < patch.window.v1; ++v)
        for (int u = patch.window.u0; u < patch.window.u1; ++u) {
          const float z = patch.at(u, v);
          if (!(z < no_surface) || (depth(u, v) > 0.0F && depth(u, v) <= z)) continue;
          depth(u, v) = z;
          of(u, v) = static_cast<std::uint32_t>(i);
        }
      if (const auto seen =
              seen_at(world_from_model * Eigen::Vector3d(0, 0, 0.5 * double{model.mesh.bounds().max().z()}));
          seen && in_image(*seen))
        names.emplace_back(*seen, printable(model.name, 30));
    }
    const Image<float> light = shading(depth, k_, k_.window(), 0);
    Image<Rgb> image = painted([&](int, int) { return scaled(reading_color, 0.5F); });
    for (std::size_t i = 0; i < image.size(); ++i)
      if (depth[i] > 0.0F) image[i] = scaled(object_color(of[i]), light[i]);
    return image;
  }

  const Scene& raw_;
  const Scene& scene_;
  const Inspection& found_;
  const Intrinsics& k_;
  double scale_;
  Image<float> light_;
};

}  // namespace

std::string draw_inspection(const Scene& raw, const Scene& scene, const Inspection& found) {
  return InspectionPicture(raw, scene, found).png();
}

}  // namespace perch::app
