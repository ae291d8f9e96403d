#include "simulate_pictures.hpp"

#include <algorithm>
#include <cmath>

#include "picture_canvas.hpp"
#include "picture_panels.hpp"
#include "picture_shading.hpp"

namespace perch::app {
namespace {

constexpr Rgb sheet_ink{25, 28, 33}, table_color{120, 122, 128}, model_color{150, 168, 190};
constexpr Font sheet_font{14, false};
constexpr double sheet_margin = 20, sheet_gap = 12, caption = 24;

template <typename ColorOf>
Image<Rgb> shaded(const DepthImage& depth, const Intrinsics& intrinsics, const Window& window, int smoothing,
                  const ColorOf& color_of) {
  const Image<float> light = shading(depth, intrinsics, window, smoothing);
  Image<Rgb> image(window.width(), window.height(), panel_background);
  for (int v = window.v0; v < window.v1; ++v)
    for (int u = window.u0; u < window.u1; ++u)
      if (depth(u, v) > 0.0F)
        image(u - window.u0, v - window.v0) = scaled(color_of(u, v), light(u - window.u0, v - window.v0));
  return image;
}

/// The objects and a margin about them, as wide to high as the image.
Window view_of(const RenderedLayout& rendered, const Intrinsics& intrinsics) {
  Window objects;
  for (const Window& window : rendered.windows) objects = bounding(objects, window);
  const double scale = 1.15 * std::max(static_cast<double>(objects.width()) / intrinsics.width,
                                       static_cast<double>(objects.height()) / intrinsics.height);
  if (scale >= 1.0) return intrinsics.window();
  const int width = static_cast<int>(scale * intrinsics.width),
            height = static_cast<int>(scale * intrinsics.height);
  const int u0 = std::clamp((objects.u0 + objects.u1 - width) / 2, 0, intrinsics.width - width);
  const int v0 = std::clamp((objects.v0 + objects.v1 - height) / 2, 0, intrinsics.height - height);
  return {u0, v0, u0 + width, v0 + height};
}

/// One model, seen from its front left and a little from above, on white.
Image<Rgb> model_image(const SceneModel& model, int pixels, double metres) {
  constexpr double distance = 1.6;
  const double focal = pixels * distance / metres;
  const double centre = 0.5 * (pixels - 1);
  SceneLayout layout;
  const Pose pose{0, 0, -0.5};
  const Eigen::Vector3d middle = world_from_model(pose, 0) * model.mesh.bounds().center().cast<double>();
  const Eigen::Vector3d from(0.0, -distance * std::cos(0.5), distance * std::sin(0.5));
  layout.camera = camera_looking_at({pixels, pixels, focal, focal, centre, centre}, middle + from, middle);
  layout.models = {model};
  layout.objects = {{0, pose}};
  const DepthImage depth = render_layout(layout).depth;
  Image<Rgb> image = shaded(depth, layout.camera.intrinsics, layout.camera.intrinsics.window(), 0,
                            [](int, int) { return model_color; });
  for (std::size_t i = 0; i < image.size(); ++i)
    if (!(depth[i] > 0.0F)) image[i] = {255, 255, 255};
  return image;
}

}  // namespace

SceneThumbnail thumbnail(const MadeScene& made, const std::string& title) {
  const Scene& scene = made.simulated.scene;
  const Intrinsics& intrinsics = scene.camera.intrinsics;
  const auto of_object = [&](int u, int v) { return !scene.mask || (*scene.mask)(u, v) != 0; };
  std::vector<float> depths;
  for (int v = 0; v < scene.depth.height(); ++v)
    for (int u = 0; u < scene.depth.width(); ++u)
      if (scene.depth(u, v) > 0.0F && of_object(u, v)) depths.push_back(scene.depth(u, v));
  const DepthRange range = depth_range(std::move(depths));

  SceneLayout layout{{}, scene.camera, scene.models, {}, {}};
  for (const TruthPose& truth : scene.truth) layout.objects.push_back({truth.model, truth.pose});
  const RenderedLayout ideal = render_layout(layout);
  const Window view = view_of(ideal, intrinsics);
  return {title,
          shaded(scene.depth, intrinsics, view, 2,
                 [&](int u, int v) {
                   return of_object(u, v) ? depth_color(range.place(scene.depth(u, v)))
                                          : scaled(table_color, 0.5F);
                 }),
          shaded(ideal.depth, intrinsics, view, 0, [&](int u, int v) {
            return object_color(static_cast<std::size_t>(ideal.objects(u, v) - 1));
          })};
}

std::string draw_scenes(const std::vector<SceneThumbnail>& scenes) {
  constexpr double width = 320;
  const Image<Rgb>& first = scenes.front().readings;
  const double height = std::round(width * first.height() / first.width());
  const std::size_t columns = std::min<std::size_t>(scenes.size(), 2);
  const std::size_t rows = (scenes.size() + columns - 1) / columns;
  const double pair = 2 * width + sheet_gap;
  Canvas canvas(static_cast<int>(2 * sheet_margin + static_cast<double>(columns) * (pair + 2 * sheet_gap) -
                                 2 * sheet_gap),
                static_cast<int>(2 * sheet_margin +
                                 static_cast<double>(rows) * (height + caption + sheet_gap) - sheet_gap));
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const double left = sheet_margin + static_cast<double>(i % columns) * (pair + 2 * sheet_gap);
    const double top = sheet_margin + static_cast<double>(i / columns) * (height + caption + sheet_gap);
    canvas.text(left, top + sheet_font.size, printable(scenes[i].title, 80), sheet_font, sheet_ink);
    canvas.draw(scenes[i].readings, {left, top + caption, width, height});
    canvas.draw(scenes[i].objects, {left + width + sheet_gap, top + caption, width, height});
  }
  return canvas.png();
}

std::string draw_models(const std::vector<SceneModel>& models) {
  constexpr int cell = 168, oversampling = 2;
  double largest = 0.0;
  for (const SceneModel& model : models)
    largest = std::max(largest, double{model.mesh.bounds().diagonal().norm()});
  const std::size_t columns = std::min<std::size_t>(models.size(), 9);
  const std::size_t rows = (models.size() + columns - 1) / columns;
  const double step_y = cell + caption + sheet_gap;
  Canvas canvas(static_cast<int>(2 * sheet_margin + static_cast<double>(columns) * cell),
                static_cast<int>(2 * sheet_margin + static_cast<double>(rows) * step_y - sheet_gap));
  for (std::size_t i = 0; i < models.size(); ++i) {
    const double left = sheet_margin + static_cast<double>(i % columns) * cell;
    const double top = sheet_margin + static_cast<double>(i / columns) * step_y;
    canvas.draw(model_image(models[i], oversampling * cell, 1.02 * largest), {left, top, cell, cell});
    const double indent = 0.5 * (cell - canvas.text_width(models[i].name, sheet_font));
    canvas.text(left + indent, top + cell + sheet_font.size, models[i].name, sheet_font, sheet_ink);
  }
  return canvas.png();
}

}  // namespace perch::app
