#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "command.hpp"
#include "inspect_picture.hpp"
#include "inspection.hpp"
#include "perch/io/atomic_write.hpp"
#include "perch/io/scene_file.hpp"
#include "perch/localize/prepare.hpp"

namespace perch::app {
namespace {

constexpr double in_degrees = 180.0 / std::numbers::pi;
enum InspectStatus { exit_looks_right = 0, exit_looks_wrong = 1 };

struct InspectOptions {
  std::string scene, output;
  SettingsOptions settings;
};

void print_camera(const Scene& scene) {
  const Intrinsics& k = scene.camera.intrinsics;
  fmt::print("camera      {} x {} pixels, {:.0f} x {:.0f} degrees of view", k.width, k.height,
             2 * std::atan(0.5 * k.width / k.fx) * in_degrees,
             2 * std::atan(0.5 * k.height / k.fy) * in_degrees);
  const Eigen::Vector3d eye = scene.camera.world_from_camera.translation(),
                        forward = scene.camera.world_from_camera.linear().col(2);
  if (scene.has_camera_pose)
    fmt::print("; at ({:.3f}, {:.3f}, {:.3f}) m, looking {:.0f} degrees down", eye.x(), eye.y(), eye.z(),
               -std::asin(std::clamp(forward.z(), -1.0, 1.0)) * in_degrees);
  fmt::print("\n");
}

void print_depth(const Scene& scene, const DepthFacts& depth) {
  fmt::print(
      "depth       {:.3f} to {:.3f} m, median {:.3f}; readings at {:.0f} % of the pixels; steps of {:g} m\n",
      depth.low, depth.high, depth.median, 100 * depth.readings, scene.depth_scale);
  fmt::print(
      "I           {} points, {:.1f} % of the pixels; {:.0f} cm^2 seen, the largest part {:.2f} m across\n",
      depth.points, 100 * depth.observed, 1e4 * depth.area, depth.largest_blob);
}

void print_plane(const Scene& raw, const Inspection& found) {
  if (const auto& plane = found.plane) {
    fmt::print("plane       {:.3f} m from the camera, {:.0f} % of the readings, {:.1f} mm rms",
               plane->distance, 100 * plane->share, 1000 * plane->rms);
    if (found.plane_tilt && raw.has_camera_pose)
      fmt::print("; tilted {:.2f} degrees against the given world, height {:.4f} m",
                 *found.plane_tilt * in_degrees, *found.plane_height);
    fmt::print("\n");
  } else {
    fmt::print("plane       {}\n", raw.background == Background::table || raw.mask
                                       ? "none found"
                                       : "not looked for: the background is removed");
  }
  if (found.table_height)
    fmt::print("table       height {:.4f} m, {}\n", *found.table_height,
               raw.table_height ? "given" : "estimated");
}

void print_workspace(const Scene& scene) {
  if (const auto& w = scene.workspace)
    fmt::print("workspace   x {:g} to {:g}, y {:g} to {:g} m\n", w->x_min, w->x_max, w->y_min, w->y_max);
  else
    fmt::print("workspace   from the observed points\n");
}

void print_models(const Inspection& found) {
  std::size_t width = 5;
  for (const ModelFacts& m : found.models) width = std::max(width, m.name.size());
  fmt::print("{:<{}}  {:>21} {:>19} {:>9} {:>7} {:>11} {:>10}\n", "model", width, "size [mm]", "origin [mm]",
             "triangles", "closed", "symmetry", "grid poses");
  for (const ModelFacts& m : found.models)
    fmt::print(
        "{:<{}}  {:>21} {:>19} {:>9} {:>7} {:>11} {:>10}\n", m.name, width,
        fmt::format("{:.0f} x {:.0f} x {:.0f}", 1000 * m.size.x(), 1000 * m.size.y(), 1000 * m.size.z()),
        fmt::format("{:.0f}, {:.0f}", 1000 * m.origin.x(), 1000 * m.origin.y()), m.triangles,
        m.closed ? "yes" : "no",
        m.stated == m.found ? m.stated.name() : m.stated.name() + "/" + m.found.name(), m.grid_poses);
}

int inspect_scene(const InspectOptions& options) {
  const Settings settings = options.settings.read();
  const auto executor = make_executor(settings.threads);
  const Scene raw = read_scene(options.scene);
  std::optional<Scene> ready;
  std::string fault;
  try {
    ready = prepare(raw, settings, *executor);
  } catch (const InputError& error) {
    fault = error.what();
  }
  const Inspection found =
      blaming(options.scene, [&] { return inspect(raw, ready, fault, settings, *executor); });
  if (!options.output.empty()) {
    OutputSet outputs;
    outputs.add("inspection.png", draw_inspection(raw, ready ? *ready : raw, found));
    outputs.commit(options.output);
  }
  fmt::print("{}\n", one_line(raw.name));
  print_camera(ready ? *ready : raw);
  print_depth(raw, found.depth);
  print_plane(raw, found);
  print_workspace(ready ? *ready : raw);
  print_models(found);
  if (found.seconds)
    fmt::print("{} grid poses, about {:.2g} s on {} threads\n", found.grid_poses, *found.seconds,
               executor->workers());
  for (const Warning& warning : found.warnings)
    fmt::print("WARNING: {}{}{}\n", one_line(warning.key), warning.key.empty() ? "" : " ",
               one_line(warning.what + (warning.remedy.empty() ? "" : "; " + warning.remedy)));
  if (found.warnings.empty()) fmt::print("nothing looks wrong\n");
  return found.warnings.empty() ? exit_looks_right : exit_looks_wrong;
}

}  // namespace

void add_inspect(CLI::App& app, Run& run) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* command =
      app.add_subcommand("inspect", "look a scene over before it is searched: units, poses, plane, models");
  command->footer(
      "Exit status: 0 nothing looks wrong; 1 something does; 2 bad usage or input that can't be read.");
  command->add_option("scene", options->scene, "scene file (YAML)")->required();
  command->add_option("-o,--output", options->output,
                      "folder for inspection.png: depth, plane and workspace, models");
  options->settings.add_to(*command, {{"--delta", "cost.delta"},
                                      {"--resolution", "grid.resolution"},
                                      {"--yaw-resolution-deg", "grid.yaw_resolution_deg"},
                                      {"--time-limit", "search.time_limit"},
                                      {"--threads", "threads"}});
  command->callback([options, &run] { run = [options] { return inspect_scene(*options); }; });
}

}  // namespace perch::app
