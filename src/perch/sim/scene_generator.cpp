#include "perch/sim/scene_generator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "perch/core/error.hpp"
#include "perch/core/random.hpp"
#include "perch/sim/footprint.hpp"
#include "perch/sim/parametric_models.hpp"

namespace perch {
namespace {

constexpr double focal_length_at_640 = 525.0;

Camera camera_of(const TabletopOptions& options) {
  const double focal = focal_length_at_640 * options.width / 640.0;
  const Intrinsics intrinsics{
      options.width, options.height, focal, focal, 0.5 * (options.width - 1), 0.5 * (options.height - 1)};
  const Workspace& w = options.workspace;
  // A little above the table, where the objects' middles are.
  const Eigen::Vector3d middle(0.5 * (w.x_min + w.x_max), 0.5 * (w.y_min + w.y_max), 0.07);
  const Eigen::Vector3d towards_camera(0.0, -std::cos(options.camera_elevation),
                                       std::sin(options.camera_elevation));
  return camera_looking_at(intrinsics, middle + options.camera_distance * towards_camera, middle);
}

std::vector<std::string> names_of(const TabletopOptions& options) {
  return options.models.empty() ? household_model_names() : options.models;
}

/// Which models take part, counting into the names, one entry an object.
std::vector<std::size_t> draw_models(Random& random, const TabletopOptions& options, std::size_t names) {
  const auto range = static_cast<std::uint64_t>(options.max_objects - options.min_objects) + 1;
  const std::size_t count = static_cast<std::size_t>(options.min_objects) + random.below(range);
  std::vector<std::size_t> left(names), drawn;
  for (std::size_t i = 0; i < names; ++i) left[i] = i;
  while (drawn.size() < count) {
    const std::size_t pick = random.below(left.size());
    drawn.push_back(left[pick]);
    if (!options.repeats) left.erase(left.begin() + static_cast<std::ptrdiff_t>(pick));
  }
  std::sort(drawn.begin(), drawn.end());
  return drawn;
}

/// One try at putting each object somewhere free.
std::optional<std::vector<PlacedModel>> place(Random& random, const TabletopOptions& options,
                                              const std::vector<std::size_t>& objects,
                                              const std::vector<Footprint>& footprints) {
  constexpr int tries = 100;
  const Workspace& w = options.workspace;
  std::vector<PlacedModel> placed;
  std::vector<Footprint> taken;
  for (const std::size_t model : objects) {
    bool found = false;
    for (int i = 0; i < tries && !found; ++i) {
      Pose pose;
      pose.x = random.uniform(w.x_min, w.x_max);
      pose.y = random.uniform(w.y_min, w.y_max);
      pose.yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
      const Footprint footprint = footprints[model].at(pose);
      found = std::all_of(taken.begin(), taken.end(), [&](const Footprint& other) {
        return gap(footprint, other) >= std::max(options.least_gap, 1e-9);
      });
      if (!found) continue;
      placed.push_back({model, pose});
      taken.push_back(footprint);
    }
    if (!found) return std::nullopt;
  }
  return placed;
}

}  // namespace

void TabletopOptions::check() const {
  const auto require = [](bool holds, const char* field, auto value, const char* range) {
    if (!holds) throw InvalidSetting(fmt::format("tabletop.{} is {}; it must be {}", field, value, range));
  };
  require(min_objects >= 1, "min_objects", min_objects, ">= 1");
  require(max_objects >= min_objects, "max_objects", max_objects, ">= min_objects");
  const std::vector<std::string> names = names_of(*this);
  for (const std::string& name : names) household_model(name);
  require(repeats || static_cast<std::size_t>(max_objects) <= names.size(), "max_objects", max_objects,
          "at most the number of models where repeats are off");
  require(std::isfinite(camera_distance) && camera_distance > 0.0, "camera_distance", camera_distance,
          "finite and > 0 (metres)");
  require(camera_elevation >= 0.0 && camera_elevation < 0.5 * std::numbers::pi, "camera_elevation",
          camera_elevation, "in [0, pi/2) (radians)");
  require(workspace.x_min <= workspace.x_max, "workspace.x_min", workspace.x_min, "<= x_max");
  require(workspace.y_min <= workspace.y_max, "workspace.y_min", workspace.y_min, "<= y_max");
  require(std::isfinite(least_gap) && least_gap >= 0.0, "least_gap", least_gap, "finite and >= 0 (metres)");
  require(least_visible >= 0.0 && least_visible <= 1.0, "least_visible", least_visible, "in [0, 1]");
  camera_of(*this).intrinsics.check();
  sensor.check();
}

SimulatedScene random_tabletop(std::uint64_t seed, const TabletopOptions& options) {
  options.check();
  constexpr int tries = 200;
  Random random(seed);
  const std::vector<std::string> names = names_of(options);
  const std::vector<std::size_t> drawn = draw_models(random, options, names.size());

  SceneLayout layout;
  layout.name = fmt::format("tabletop_{}", seed);
  layout.camera = camera_of(options);
  layout.workspace = options.workspace;
  std::vector<Footprint> footprints;
  std::vector<std::size_t> objects;  // counting into the models that take part
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (i == 0 || drawn[i] != drawn[i - 1]) {
      layout.models.push_back(household_model(names[drawn[i]]));
      footprints.emplace_back(layout.models.back().mesh);
    }
    objects.push_back(layout.models.size() - 1);
  }

  DepthSensorSettings sensor = options.noise ? options.sensor : DepthSensorSettings::clean();
  if (!sensor.focal_length) sensor.focal_length = focal_length_at_640;
  for (int i = 0; i < tries; ++i) {
    const auto placed = place(random, options, objects, footprints);
    if (!placed) continue;
    layout.objects = *placed;
    const RenderedLayout rendered = render_layout(layout);
    const bool in_view =
        std::all_of(rendered.windows.begin(), rendered.windows.end(),
                    [&](const Window& window) { return clear_of_border(window, layout.camera.intrinsics); });
    const bool seen = std::all_of(rendered.visible_fractions.begin(), rendered.visible_fractions.end(),
                                  [&](double fraction) { return fraction >= options.least_visible; });
    if (in_view && seen) return simulate(layout, sensor, random.next());
  }
  throw InvalidSetting(fmt::format(
      "tabletop.max_objects is {}; {} objects found no room in {} tries: allow fewer, a larger workspace, or "
      "less to be visible",
      options.max_objects, objects.size(), tries));
}

}  // namespace perch
