// Times the localization of one scene, a generated one or a scene file, in a process of its own, so that the
// peak of its memory is that of the scene. Prints one line of JSON.

#include <fmt/format.h>
#include <sys/resource.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "perch/core/error.hpp"
#include "perch/core/stopwatch.hpp"
#include "perch/io/scene_file.hpp"
#include "perch/localize/localize.hpp"
#include "perch/sim/scene_generator.hpp"
#include "scene_variants.hpp"

namespace perch {
namespace {

struct Options {
  std::optional<std::string> file;
  std::uint64_t seed = 1;
  int objects = 5;
  std::vector<std::string> models;
  double focal_scale = 1.0;
  std::optional<int> width, height;
  std::vector<double> workspace;
  std::optional<std::size_t> triangles;
  std::string w = "3", threads = "1", resolution = "0.04", yaw_resolution_deg = "22.5", time_limit = "60";
  std::vector<std::string> assignments;
};

void add_to(CLI::App& app, Options& options) {
  app.add_option("scene", options.file, "scene file; without one, a random tabletop is made");
  app.add_option("--seed", options.seed, "of the random tabletop")->capture_default_str();
  app.add_option("--objects", options.objects, "on the random tabletop")->capture_default_str();
  app.add_option("--models", options.models, "household models to draw from; all if not given")
      ->delimiter(',');
  app.add_option("--focal-scale", options.focal_scale, "of the random tabletop's camera: 1 is 640 x 480")
      ->capture_default_str();
  app.add_option("--width", options.width, "pads the image to so many columns, the view as it is");
  app.add_option("--height", options.height, "pads the image to so many rows");
  app.add_option(
         "--workspace", options.workspace,
         "x_min,x_max,y_min,y_max: where objects are looked for, metres; the scene's own if not given")
      ->delimiter(',')
      ->expected(4);
  app.add_option("--triangles", options.triangles,
                 "divides the models' triangles until each model has so many");
  app.add_option("--w", options.w)->capture_default_str();
  app.add_option("--threads", options.threads)->capture_default_str();
  app.add_option("--resolution", options.resolution, "grid step, metres")->capture_default_str();
  app.add_option("--yaw-resolution-deg", options.yaw_resolution_deg)->capture_default_str();
  app.add_option("--time-limit", options.time_limit, "seconds")->capture_default_str();
  app.add_option("--set", options.assignments, "sets any other field of the settings, key=value")
      ->allow_extra_args(false);
}

Scene make_scene(const Options& options) {
  if (options.file) return read_scene(*options.file);
  TabletopOptions tabletop;
  tabletop.min_objects = tabletop.max_objects = options.objects;
  tabletop.models = options.models;
  tabletop.width = static_cast<int>(std::lround(640 * options.focal_scale));
  tabletop.height = static_cast<int>(std::lround(480 * options.focal_scale));
  return random_tabletop(options.seed, tabletop).scene;
}

Scene varied(Scene scene, const Options& options) {
  if (const auto& w = options.workspace; !w.empty()) scene.workspace = Workspace{w[0], w[1], w[2], w[3]};
  if (options.triangles)
    for (SceneModel& model : scene.models) model.mesh = with_triangles(model.mesh, *options.triangles);
  const Intrinsics& intrinsics = scene.camera.intrinsics;
  if (options.width || options.height)
    return padded(scene, options.width.value_or(intrinsics.width),
                  options.height.value_or(intrinsics.height));
  return scene;
}

Settings make_settings(const Options& options) {
  Settings settings;
  set_field(settings, "search.w", options.w);
  set_field(settings, "threads", options.threads);
  set_field(settings, "grid.resolution", options.resolution);
  set_field(settings, "grid.yaw_resolution_deg", options.yaw_resolution_deg);
  set_field(settings, "search.time_limit", options.time_limit);
  for (const std::string& assignment : options.assignments) {
    const auto equals = assignment.find('=');
    if (equals == std::string::npos)
      throw InvalidSetting(fmt::format("--set {}: give key=value, e.g. --set cost.delta=0.005", assignment));
    set_field(settings, assignment.substr(0, equals), assignment.substr(equals + 1));
  }
  settings.check();
  settings.check_together();
  return settings;
}

/// Processor seconds of all threads of this process.
double process_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double peak_resident_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

nlohmann::ordered_json measure(const Scene& scene, const Settings& settings) {
  const auto executor = make_executor(settings.threads);
  const double before = process_seconds();
  const Stopwatch watch;
  const Result result = localize(scene, settings, *executor, StopCondition::after(settings.time_limit));
  const double seconds = watch.seconds(), core_seconds = process_seconds() - before;

  std::vector<std::size_t> triangles;
  for (const SceneModel& model : scene.models) triangles.push_back(model.mesh.triangles.size());
  const Seconds& parts = result.stats.seconds;
  nlohmann::ordered_json line;
  line["scene"] = scene.name;
  line["objects"] = scene.objects.size();
  line["width"] = scene.camera.intrinsics.width;
  line["height"] = scene.camera.intrinsics.height;
  line["most_triangles"] = *std::max_element(triangles.begin(), triangles.end());
  line["w"] = settings.w;
  line["threads"] = executor->workers();
  line["resolution"] = settings.candidates.grid.resolution;
  line["seconds"] = {{"total", seconds},
                     {"candidates", parts.candidates},
                     {"search", parts.search},
                     {"polish", parts.polish}};
  line["core_seconds"] = core_seconds;
  line["rendered"] = result.stats.rendered;
  line["core_ms_per_hypothesis"] =
      result.stats.rendered > 0
          ? nlohmann::ordered_json(1000.0 * core_seconds / static_cast<double>(result.stats.rendered))
          : nlohmann::ordered_json();
  line["cost"] = result.cost ? nlohmann::ordered_json(result.cost->cost) : nlohmann::ordered_json();
  line["search_cost"] =
      result.search_cost ? nlohmann::ordered_json(*result.search_cost) : nlohmann::ordered_json();
  line["lower_bound"] = result.lower_bound;
  line["status"] = name(result.status);
  line["peak_resident_mb"] = peak_resident_megabytes();
  return line;
}

}  // namespace
}  // namespace perch

int main(int argc, char** argv) {
  CLI::App app("times the localization of one scene");
  perch::Options options;
  perch::add_to(app, options);
  CLI11_PARSE(app, argc, argv);
  try {
    const perch::Settings settings = perch::make_settings(options);
    const perch::Scene scene = perch::varied(perch::make_scene(options), options);
    fmt::print("{}\n", perch::measure(scene, settings).dump());
  } catch (const perch::InputError& error) {
    fmt::print(stderr, "perch_scene_bench: {}\n", error.what());
    return 2;
  }
  return 0;
}
