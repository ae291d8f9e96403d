#pragma once

namespace perch {

/// What a rendered point costs where the depth image has no reading.
enum class MissingDepth {
  unexplained,  ///< it counts as unexplained, as the formula says
  ignore        ///< it is left out of R
};

struct CostSettings {
  double delta =
      0.005;  ///< sensor resolution, metres: a point farther than this from a cloud is unexplained by it
  MissingDepth missing_depth = MissingDepth::unexplained;

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

}  // namespace perch
