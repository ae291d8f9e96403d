#pragma once

namespace perch {

/// What a rendered point costs where the depth image has no reading.
enum class MissingDepth {
  unexplained,  ///< it counts as unexplained, as the formula says
  ignore        ///< it is left out of R
};

/// What unexplained points of I cost where they may belong to clutter.
enum class ClutterPoints {
  charge,  ///< 1 each, as the formula says
  ignore   ///< nothing
};

struct CostSettings {
  double delta =
      0.005;  ///< sensor resolution, metres: a point farther than this from a cloud is unexplained by it
  MissingDepth missing_depth = MissingDepth::unexplained;
  /// Things may be in view that no model describes: a rendered point hidden behind a nearer reading costs
  /// `clutter_weight`, and points of I count as `clutter_points` says.
  bool clutter = false;
  double clutter_weight = 0.75;  ///< in (0, 1]
  ClutterPoints clutter_points = ClutterPoints::charge;

  /// True where unexplained points of I cost something.
  bool charges_points() const { return !clutter || clutter_points == ClutterPoints::charge; }
  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

}  // namespace perch
