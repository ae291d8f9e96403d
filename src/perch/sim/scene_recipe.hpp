#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "perch/localize/scene.hpp"
#include "perch/sim/depth_sensor.hpp"

namespace perch {

/// Where objects are put.
enum class SceneLayoutKind {
  tabletop,  ///< anywhere in the workspace, at any yaw
  chess      ///< on the squares of a board
};

/// From the least to the most, both included.
struct Span {
  double least = 0.0, most = 0.0;
};

/// What the scenes of a set have in common. Each scene draws what is left open.
struct SceneRecipe {
  SceneLayoutKind layout = SceneLayoutKind::tabletop;
  int min_objects = 3, max_objects = 5;  ///< 1 to 255
  /// How often one model, drawn for each scene, stands in it; all others stand in it once. Tabletop only.
  int repeats = 1;
  /// Names of models to draw from (named_model). For chess: unused.
  std::vector<std::string> models;
  /// Of every object at least the least is visible, and of the most hidden one at most the most: pixels at
  /// which an object is the nearest, of those that it would cover alone.
  Span visible{0.2, 1.0};
  Span distance{0.8, 1.0};     ///< of the camera from the middle of the workspace, metres
  Span elevation_deg{25, 45};  ///< how far it looks down, degrees
  Span azimuth_deg{0, 360};    ///< from which side it looks, degrees; 0: from -y, 90: from +x
  double workspace_x = 0.44;   ///< extent of where object origins are put, about the world's origin, metres
  double workspace_y = 0.32;   ///< metres
  double least_gap = 0.005;    ///< between the objects seen from above, metres
  int width = 640, height = 480;  ///< pixels; the focal length is 525 pixels at 640 and scales with the width
  DepthSensorSettings sensor;     ///< without a focal_length, that of a 640-pixel image is used
  bool table = false;             ///< the table stays in the depth image and a mask tells the objects

  /// That of a chess board: 12 pieces on its squares, at the distance where it fits the image.
  static SceneRecipe chess();
  /// Throws InvalidSetting naming what is wrong with which value, InputError for an unknown model.
  void check() const;
  Workspace workspace() const;
};

/// How far the table reaches beyond the workspace on each side, metres.
inline constexpr double table_margin = 0.3;

/// A seed for one scene of a set: any two scenes' differ, and each depends on the set's seed and its own
/// number alone.
std::uint64_t scene_seed(std::uint64_t set_seed, std::uint64_t index);

}  // namespace perch
