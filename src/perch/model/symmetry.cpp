#include "perch/model/symmetry.hpp"

#include <fmt/format.h>

#include <cmath>

#include "perch/core/error.hpp"
#include "perch/core/pose.hpp"

namespace perch {

Symmetry Symmetry::n_fold(int n) {
  if (n < 1 || n > 360)
    throw InvalidSetting(
        fmt::format("symmetry is {}; an n-fold symmetry takes a whole number from 1 to 360", n));
  return Symmetry(n);
}

std::string Symmetry::name() const {
  if (is_continuous()) return "continuous";
  return fold_ == 1 ? "none" : std::to_string(fold_);
}

double Symmetry::yaw_difference(double a, double b) const {
  return is_continuous() ? 0.0 : angle_difference(a, b, period());
}

double Symmetry::canonical_yaw(double yaw) const {
  if (is_continuous()) return 0.0;
  if (fold_ == 1) return wrap_angle(yaw);
  const double reduced = yaw - std::floor(yaw / period()) * period();
  return reduced >= period() || reduced < 0.0 ? 0.0 : reduced;
}

}  // namespace perch
