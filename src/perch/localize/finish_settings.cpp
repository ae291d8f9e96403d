#include "perch/localize/finish_settings.hpp"

#include <fmt/format.h>

#include <string_view>

#include "perch/core/error.hpp"

namespace perch {
namespace {

void in_range(std::string_view field, double value, double low, double high, std::string_view unit = "") {
  if (!(value >= low && value <= high))
    throw InvalidSetting(
        fmt::format("{} is {}; it must lie between {} and {}{}", field, value, low, high, unit));
}

}  // namespace

void DescentSettings::check() const {
  in_range("polish.smallest_step", smallest_step, 1e-6, 1.0, " metres");
  in_range("polish.largest_step", largest_step, smallest_step, 1.0, " metres");
  in_range("polish.turns", turns, 0, 360);
  in_range("polish.residual_weight", residual_weight, 0.0, 1e6);
}

void PolishSettings::check() const {
  in_range("polish.rounds", rounds, 0, 1000);
  in_range("polish.scenes", scenes, 1, 1000);
  in_range("polish.trials", trials, 1, 1e6);
  descent.check();
}

void AmbiguitySettings::check() const {
  constexpr double degree = std::numbers::pi / 180.0;
  in_range("ambiguity.distance", distance, 1e-6, 100.0, " metres");
  in_range("ambiguity.yaw_deg", yaw / degree, 1e-3, 180.0, " degrees");
  in_range("ambiguity.descents", descents, 0, 1000);
  in_range("ambiguity.trials", trials, 0, 1e6);
}

}  // namespace perch
