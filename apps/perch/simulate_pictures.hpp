#pragma once

#include <string>
#include <vector>

#include "perch/core/image.hpp"
#include "perch/sim/scene_maker.hpp"

namespace perch::app {

/// A scene small enough to be kept for a sheet.
struct SceneThumbnail {
  std::string title;
  Image<Rgb> readings;  ///< shaded; yellow near, violet far; the table grey
  Image<Rgb> objects;   ///< without the sensor's faults, a colour each
};

SceneThumbnail thumbnail(const MadeScene& made, const std::string& title);

/// The bytes of a PNG file that shows scenes side by side.
std::string draw_scenes(const std::vector<SceneThumbnail>& scenes);

/// The bytes of a PNG file that shows models side by side, all at one scale, with their names.
std::string draw_models(const std::vector<SceneModel>& models);

}  // namespace perch::app
