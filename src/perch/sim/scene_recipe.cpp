#include "perch/sim/scene_recipe.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "perch/core/error.hpp"
#include "perch/core/random.hpp"
#include "perch/sim/chess_pieces.hpp"
#include "perch/sim/model_catalogue.hpp"

namespace perch {
namespace {

constexpr int most_objects = 255;  // masks.png numbers them in a byte
constexpr int chess_set = 32;

void require_setting(bool holds, const char* what, const std::string& value, const std::string& wanted) {
  if (!holds) throw InvalidSetting(fmt::format("{} {}: it must be {}", what, value, wanted));
}

void check_span(const char* what, const Span& span, double least, double most, const char* wanted) {
  const bool holds = std::isfinite(span.least) && std::isfinite(span.most) && span.least <= span.most &&
                     span.least >= least && span.most <= most;
  require_setting(holds, what, fmt::format("{}-{}", span.least, span.most), wanted);
}

}  // namespace

SceneRecipe SceneRecipe::chess() {
  SceneRecipe recipe;
  recipe.layout = SceneLayoutKind::chess;
  recipe.min_objects = recipe.max_objects = 12;
  recipe.distance = {0.65, 0.85};
  recipe.workspace_x = recipe.workspace_y = 8 * chess_square;
  return recipe;
}

void SceneRecipe::check() const {
  const std::string objects = fmt::format("{}-{}", min_objects, max_objects);
  const bool chess = layout == SceneLayoutKind::chess;
  const int most = chess ? chess_set : most_objects;
  require_setting(min_objects >= 1 && max_objects >= min_objects && max_objects <= most, "objects", objects,
                  fmt::format("a range within 1 to {}", most));
  if (!chess) {
    if (models.empty()) throw InvalidSetting("models: the list is empty; name at least one");
    std::set<std::string> names;
    for (const std::string& name : models) {
      named_model(name);
      if (!names.insert(name).second) throw InvalidSetting(fmt::format("models: {} is named twice", name));
    }
    require_setting(repeats >= 1 && repeats <= min_objects, "repeats", std::to_string(repeats),
                    fmt::format("from 1 to the least number of objects, {}", min_objects));
    require_setting(
        static_cast<std::size_t>(max_objects - repeats + 1) <= models.size(), "objects", objects,
        fmt::format("at most {}: there are {} models, of which one may stand there {} times",
                    models.size() + static_cast<std::size_t>(repeats) - 1, models.size(), repeats));
  }
  check_span("visible", visible, 0.0, 1.0, "a range within 0 to 1");
  check_span("distance", distance, 0.1, 10.0, "a range within 0.1 to 10 metres");
  check_span("elevation", elevation_deg, 0.0, 89.0, "a range within 0 to 89 degrees");
  check_span("azimuth", azimuth_deg, 0.0, 360.0, "a range within 0 to 360 degrees");
  check_span("workspace", {workspace_x, workspace_x}, 0.01, 5.0, "0.01 to 5 metres wide");
  check_span("workspace", {workspace_y, workspace_y}, 0.01, 5.0, "0.01 to 5 metres deep");
  check_span("gap", {least_gap, least_gap}, 0.0, 1.0, "0 to 1 metres");
  constexpr int least_side = 16, most_side = 4096;
  require_setting(width >= least_side && width <= most_side && height >= least_side && height <= most_side,
                  "image", fmt::format("{}x{}", width, height),
                  fmt::format("{} to {} pixels each way", least_side, most_side));
  sensor.check();
}

Workspace SceneRecipe::workspace() const {
  return {-0.5 * workspace_x, 0.5 * workspace_x, -0.5 * workspace_y, 0.5 * workspace_y};
}

std::uint64_t scene_seed(std::uint64_t set_seed, std::uint64_t index) {
  // Odd factors and the generator's own mixing are one to one, so no two indices share a seed.
  const std::uint64_t set = Random(set_seed).next();
  return Random(set ^ (index * 0xd1342543de82ef95ULL)).next();
}

}  // namespace perch
