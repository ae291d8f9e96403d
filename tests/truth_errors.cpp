#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "perch/io/result_file.hpp"
#include "perch/io/scene_file.hpp"

namespace {

constexpr double degrees = 180.0 / std::numbers::pi;

double distance(const perch::Pose& a, const perch::Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

using Found = perch::ReportedObject;

/// Which of `found` stands for each true pose: the nearest pairs of a model first, each used once.
std::vector<const Found*> matched(const perch::Scene& scene, const std::vector<Found>& found) {
  struct Pair {
    double distance;
    std::size_t truth, found;
  };
  std::vector<Pair> pairs;
  for (std::size_t t = 0; t < scene.truth.size(); ++t)
    for (std::size_t f = 0; f < found.size(); ++f)
      if (!found[f].absent && found[f].model == scene.truth[t].model)
        pairs.push_back({distance(scene.truth[t].pose, found[f].pose), t, f});
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  std::vector<const Found*> match(scene.truth.size(), nullptr);
  std::vector<bool> used(found.size(), false);
  for (const Pair& pair : pairs) {
    if (match[pair.truth] != nullptr || used[pair.found]) continue;
    match[pair.truth] = &found[pair.found];
    used[pair.found] = true;
  }
  return match;
}

struct Limits {
  double metres, degrees;
};

/// Prints a line for each true pose; false if one was not found, or not within the limits.
bool print_errors(const perch::Scene& scene, const std::vector<Found>& found,
                  const std::optional<Limits>& limits) {
  std::size_t width = 6;
  for (const perch::TruthPose& truth : scene.truth)
    width = std::max(width, scene.models[truth.model].name.size());
  const std::vector<const Found*> match = matched(scene, found);
  bool good = true;
  fmt::print("{:<{}}  {:>24}  {:>24}  {:>10} {:>8}\n", "object", width, "true x, y [m], yaw [°]",
             "found x, y [m], yaw [°]", "error [mm]", "yaw [°]");
  for (std::size_t i = 0; i < match.size(); ++i) {
    const perch::TruthPose& truth = scene.truth[i];
    const auto shown = [](const perch::Pose& p) {
      return fmt::format("{:7.4f} {:7.4f} {:8.1f}", p.x, p.y, p.yaw * degrees);
    };
    fmt::print("{:<{}}  {:>24}  ", scene.models[truth.model].name, width, shown(truth.pose));
    if (match[i] == nullptr) {
      fmt::print("not found\n");
      good = false;
      continue;
    }
    const double metres = distance(truth.pose, match[i]->pose);
    const double turned = truth.symmetry.yaw_difference(truth.pose.yaw, match[i]->pose.yaw) * degrees;
    const bool within = !limits || (metres <= limits->metres && turned <= limits->degrees);
    fmt::print("{:>24}  {:10.2f} {:8.2f}{}\n", shown(match[i]->pose), metres * 1000.0, turned,
               within ? "" : "  too far");
    good = good && within;
  }
  return good;
}

double number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw std::runtime_error(fmt::format("{}: is no number", text));
  return value;
}

}  // namespace

/// Compares a result with the truth of its scene: distances in x and y, and yaws modulo the symmetry. Exit
/// status 0; 1 if an object is missing or, with --within, farther off than that; 2 for bad usage or input.
int main(int argc, char** argv) {
  const bool limited = argc == 6 && std::string_view(argv[3]) == "--within";
  if (argc != 3 && !limited) {
    fmt::print(stderr, "usage: perch_truth_errors SCENE RESULT.json [--within METRES DEGREES]\n");
    return 2;
  }
  try {
    const perch::Scene scene = perch::read_scene(argv[1]);
    if (scene.truth.empty()) throw std::runtime_error(fmt::format("{}: has no truth", argv[1]));
    std::optional<Limits> limits;
    if (limited) limits = Limits{number(argv[4]), number(argv[5])};
    return print_errors(scene, perch::read_result(argv[2], scene).objects, limits) ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "perch_truth_errors: {}\n", error.what());
    return 2;
  }
}
