#pragma once

#include <numbers>
#include <string>

namespace perch {

/// Rotations about the model's z axis that a depth camera can't tell apart.
class Symmetry {
 public:
  static Symmetry none() { return Symmetry(1); }
  static Symmetry continuous() { return Symmetry(0); }
  /// n-fold, n in 1..360; 1 is none. Throws InvalidSetting.
  static Symmetry n_fold(int n);

  bool is_continuous() const { return fold_ == 0; }
  /// The n of an n-fold symmetry; 1 without symmetry; 0 where continuous.
  int fold() const { return fold_; }
  /// Poses whose yaws differ by a multiple of this look alike, radians. Continuous symmetry has no period:
  /// all yaws do.
  double period() const { return 2.0 * std::numbers::pi / fold_; }
  /// "none", "continuous" or the n.
  std::string name() const;
  /// The smallest difference of two yaws modulo the symmetry, radians; 0 where continuous.
  double yaw_difference(double a, double b) const;
  /// The one representative of all equal yaws: 0 where continuous, in [0, period) for an n-fold symmetry, in
  /// (-pi, pi] without one.
  double canonical_yaw(double yaw) const;

  friend bool operator==(const Symmetry&, const Symmetry&) = default;

 private:
  explicit Symmetry(int fold) : fold_(fold) {}
  int fold_;
};

}  // namespace perch
