#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "perch/sim/simulated_scene.hpp"

namespace perch {

/// What a random scene may hold and how it is looked at.
struct TabletopOptions {
  int min_objects = 3;  ///< the number of objects lies between these, both included
  int max_objects = 5;
  bool repeats = true;              ///< a model may occur more than once
  std::vector<std::string> models;  ///< names of household models to draw from; all if empty
  bool noise = true;                ///< depths as `sensor` reads them; ideal ones if false
  DepthSensorSettings sensor;       ///< without a focal_length, that of a 640-pixel image is used
  int width = 640;                  ///< pixels; the focal length is 525 pixels at 640 and scales with it
  int height = 480;                 ///< pixels
  double camera_distance = 0.9;     ///< from the middle of the workspace, metres
  double camera_elevation = 0.58;   ///< how far the camera looks down, radians
  Workspace workspace{-0.22, 0.22, -0.16, 0.16};  ///< where object origins are put
  double least_gap = 0.005;                       ///< between the objects' footprints, metres
  double least_visible = 0.2;                     ///< of every object, a fraction

  /// Throws InvalidSetting naming the field and the value; InputError for an unknown model.
  void check() const;
};

/// A scene of household models that stand on the table z = 0 without touching, all in view, seen from the
/// -y side. The same seed and options give the same scene. Throws what TabletopOptions::check throws, and
/// InvalidSetting where so many objects don't find room.
SimulatedScene random_tabletop(std::uint64_t seed, const TabletopOptions& options = {});

}  // namespace perch
