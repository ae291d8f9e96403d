#pragma once

#include <numbers>

namespace perch {

/// The steps of a descent.
struct DescentSettings {
  double largest_step = 0.004;    ///< first step, metres; of a turn: of a point at the model's radius
  double smallest_step = 0.0005;  ///< last step, metres
  int turns = 3;                  ///< other yaws, evenly spaced, that ICP starts from
  double residual_weight = 0.5;   ///< what the mean residual counts beside J, in points explained

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

/// How the poses of a scene are refined together, off the grid, after the search.
struct PolishSettings {
  int rounds = 3;    ///< times that every object is moved, at most; 0: no polish
  int scenes = 3;    ///< near-optimal scenes that are polished, at most; the best is kept
  int trials = 150;  ///< poses valued for each object of a scene, at most
  DescentSettings descent;

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

/// Which poses of an object are other poses than the answer, and how hard they are looked for.
struct AmbiguitySettings {
  double distance = 0.02;  ///< another pose is farther away than this, metres,
  double yaw =
      15.0 * std::numbers::pi / 180.0;  ///< or turned by more than this, radians, modulo the symmetry
  int descents = 3;  ///< how many of the best other poses are moved downhill, as the polish moves the answer
  int trials = 200;  ///< poses valued for each object, at most; 0: nothing is judged

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

}  // namespace perch
