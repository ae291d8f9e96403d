#include "perch/sim/scene_maker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "perch/core/error.hpp"
#include "perch/sim/chess_pieces.hpp"
#include "perch/sim/model_catalogue.hpp"

namespace perch {
namespace {

constexpr double sensor_focal_length = 525.0;  // of a 640-pixel image
constexpr int scene_tries = 3000;

double drawn_from(Random& random, const Span& span) {
  return random.uniform(span.least, span.most);
}

/// A permutation of 0 .. n - 1.
std::vector<std::size_t> shuffled(Random& random, std::size_t n) {
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = i;
  for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

/// Puts the table z = 0 behind the objects of a depth image: `workspace` and a margin about it.
void add_table(DepthImage& depth, const Camera& camera, const Workspace& workspace) {
  const RaySlopes rays(camera.intrinsics);
  const Eigen::Matrix3d world_from_camera = camera.world_from_camera.linear();
  const Eigen::Vector3d eye = camera.world_from_camera.translation();
  for (int v = 0; v < depth.height(); ++v)
    for (int u = 0; u < depth.width(); ++u) {
      if (depth(u, v) > 0.0F) continue;
      const Eigen::Vector3d ray = world_from_camera * Eigen::Vector3d(rays.x(u), rays.y(v), 1.0);
      if (ray.z() >= 0.0) continue;
      const double z = -eye.z() / ray.z();
      const Eigen::Vector3d point = eye + z * ray;
      if (point.x() >= workspace.x_min - table_margin && point.x() <= workspace.x_max + table_margin &&
          point.y() >= workspace.y_min - table_margin && point.y() <= workspace.y_max + table_margin)
        depth(u, v) = static_cast<float>(z);
    }
}

/// The layout with the models that take part alone.
SceneLayout without_unused_models(const Camera& camera, const Workspace& workspace,
                                  const std::vector<SceneModel>& models, std::vector<PlacedModel> objects) {
  SceneLayout layout{{}, camera, {}, std::move(objects), workspace};
  std::vector<std::optional<std::size_t>> number(models.size());
  for (PlacedModel& object : layout.objects) {
    auto& own = number[object.model];
    if (!own) {
      own = layout.models.size();
      layout.models.push_back(models[object.model]);
    }
    object.model = *own;
  }
  return layout;
}

}  // namespace

SceneMaker::SceneMaker(const SceneRecipe& recipe) : recipe_(recipe) {
  recipe_.check();
  if (!recipe_.sensor.focal_length) recipe_.sensor.focal_length = sensor_focal_length;
  if (recipe_.layout == SceneLayoutKind::chess) recipe_.models = chess_model_names();
  for (const std::string& name : recipe_.models) {
    models_.push_back(named_model(name));
    plans_.emplace_back(models_.back().mesh, recipe_.least_gap);
  }
}

std::vector<std::size_t> SceneMaker::draw_models(Random& random) const {
  const auto range = static_cast<std::uint64_t>(recipe_.max_objects - recipe_.min_objects) + 1;
  const auto count = static_cast<std::size_t>(recipe_.min_objects) + random.below(range);
  if (recipe_.layout == SceneLayoutKind::chess) {
    std::vector<std::size_t> pieces = draw_chess_pieces(random);
    pieces.resize(count);
    std::sort(pieces.begin(), pieces.end());
    return pieces;
  }
  const auto repeats = static_cast<std::size_t>(recipe_.repeats);
  const std::vector<std::size_t> order = shuffled(random, models_.size());
  std::vector<std::size_t> drawn(repeats, order[0]);
  drawn.insert(drawn.end(), order.begin() + 1,
               order.begin() + 1 + static_cast<std::ptrdiff_t>(count - repeats));
  std::sort(drawn.begin(), drawn.end());
  return drawn;
}

/// All 32 pieces of a game, one of each kind first.
std::vector<std::size_t> SceneMaker::draw_chess_pieces(Random& random) const {
  std::vector<std::size_t> pieces = shuffled(random, models_.size()), rest;
  for (std::size_t kind = 0; kind < models_.size(); ++kind) {
    const std::string& name = models_[kind].name;
    const int others = name == "pawn" ? 15 : name == "king" || name == "queen" ? 1 : 3;
    rest.insert(rest.end(), static_cast<std::size_t>(others), kind);
  }
  for (const std::size_t i : shuffled(random, rest.size())) pieces.push_back(rest[i]);
  return pieces;
}

Camera SceneMaker::draw_camera(Random& random) const {
  constexpr double degree = std::numbers::pi / 180.0;
  const double focal = sensor_focal_length * recipe_.width / 640.0;
  const Intrinsics intrinsics{
      recipe_.width, recipe_.height, focal, focal, 0.5 * (recipe_.width - 1), 0.5 * (recipe_.height - 1)};
  const double distance = drawn_from(random, recipe_.distance);
  const double elevation = degree * drawn_from(random, recipe_.elevation_deg);
  const double azimuth = degree * drawn_from(random, recipe_.azimuth_deg);
  // A little above the table, where the objects' middles are.
  const Eigen::Vector3d middle(0.0, 0.0, recipe_.layout == SceneLayoutKind::chess ? 0.03 : 0.07);
  const Eigen::Vector3d towards_camera(std::cos(elevation) * std::sin(azimuth),
                                       -std::cos(elevation) * std::cos(azimuth), std::sin(elevation));
  return camera_looking_at(intrinsics, middle + distance * towards_camera, middle);
}

bool SceneMaker::is_free(const PlacedModel& candidate, const std::vector<PlacedModel>& placed) const {
  return std::all_of(placed.begin(), placed.end(), [&](const PlacedModel& other) {
    return apart(plans_[candidate.model], candidate.pose, plans_[other.model], other.pose);
  });
}

bool SceneMaker::place_anywhere(Random& random, const std::vector<std::size_t>& drawn,
                                std::vector<PlacedModel>& placed) const {
  constexpr int tries = 50;
  const Workspace workspace = recipe_.workspace();
  for (const std::size_t model : drawn) {
    bool found = false;
    for (int i = 0; i < tries && !found; ++i) {
      const double x = random.uniform(workspace.x_min, workspace.x_max);
      const double y = random.uniform(workspace.y_min, workspace.y_max);
      const PlacedModel candidate{model, {x, y, random.uniform(-std::numbers::pi, std::numbers::pi)}};
      found = is_free(candidate, placed);
      if (found) placed.push_back(candidate);
    }
    if (!found) return false;
  }
  return true;
}

bool SceneMaker::place_on_squares(Random& random, const std::vector<std::size_t>& drawn,
                                  std::vector<PlacedModel>& placed) const {
  constexpr double jitter = 0.004;  // metres from a square's middle, along either axis
  const std::vector<std::size_t> squares = shuffled(random, 64);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const double column = static_cast<double>(squares[i] % 8), row = static_cast<double>(squares[i] / 8);
    const double x = chess_square * (column - 3.5) + random.uniform(-jitter, jitter);
    const double y = chess_square * (row - 3.5) + random.uniform(-jitter, jitter);
    const PlacedModel candidate{drawn[i], {x, y, random.uniform(-std::numbers::pi, std::numbers::pi)}};
    if (!is_free(candidate, placed)) return false;
    placed.push_back(candidate);
  }
  return true;
}

MadeScene SceneMaker::sensed(const SceneLayout& layout, const RenderedLayout& rendered,
                             std::uint64_t noise_seed) const {
  DepthImage ideal = rendered.depth;
  add_table(ideal, layout.camera, layout.workspace);
  SensedDepth read = sense(ideal, layout.camera.intrinsics, recipe_.sensor, noise_seed, rendered.objects);

  MadeScene made;
  made.visible = rendered.visible;
  made.alone = rendered.alone;
  made.objects = Image<std::uint8_t>(recipe_.width, recipe_.height);
  Image<std::uint8_t> mask(recipe_.width, recipe_.height);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    made.objects[i] = static_cast<std::uint8_t>(rendered.objects[i]);
    const bool of_object = read.depth[i] > 0.0F && rendered.objects[read.source[i]] != 0;
    mask[i] = of_object ? 255 : 0;
    if (!recipe_.table && !of_object) read.depth[i] = 0.0F;
  }
  made.simulated.visible_fractions = rendered.visible_fractions;
  made.simulated.scene = unobserved_scene(layout);
  made.simulated.scene.depth = std::move(read.depth);
  if (recipe_.table) made.simulated.scene.mask = std::move(mask);
  return made;
}

MadeScene SceneMaker::make(std::uint64_t seed) const {
  int without_room = 0, out_of_view = 0, too_hidden = 0, not_hidden = 0;
  Random random(seed);
  for (int i = 0; i < scene_tries; ++i) {
    const std::vector<std::size_t> drawn = draw_models(random);
    const Camera camera = draw_camera(random);
    std::vector<PlacedModel> placed;
    const bool found = recipe_.layout == SceneLayoutKind::chess ? place_on_squares(random, drawn, placed)
                                                                : place_anywhere(random, drawn, placed);
    if (!found) {
      ++without_room;
      continue;
    }
    const SceneLayout layout = without_unused_models(camera, recipe_.workspace(), models_, std::move(placed));
    const RenderedLayout rendered = render_layout(layout);
    const double least =
        *std::min_element(rendered.visible_fractions.begin(), rendered.visible_fractions.end());
    if (!std::all_of(rendered.windows.begin(), rendered.windows.end(),
                     [&](const Window& window) { return clear_of_border(window, camera.intrinsics); }))
      ++out_of_view;
    else if (least < recipe_.visible.least)
      ++too_hidden;
    else if (least > recipe_.visible.most)
      ++not_hidden;
    else {
      MadeScene made = sensed(layout, rendered, random.next());
      made.seed = seed;
      return made;
    }
  }
  throw InvalidSetting(
      fmt::format("no scene in {} tries: {} without room for all objects, {} not wholly in view, {} with an "
                  "object less visible "
                  "than {}, {} with no object hidden down to {}; ask for other numbers of objects or visible "
                  "fractions, a larger "
                  "workspace, or a camera farther away",
                  scene_tries, without_room, out_of_view, too_hidden, recipe_.visible.least, not_hidden,
                  recipe_.visible.most));
}

}  // namespace perch
