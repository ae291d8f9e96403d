#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "perch/core/image.hpp"
#include "perch/localize/rendering.hpp"
#include "perch/localize/result.hpp"
#include "perch/localize/scene.hpp"
#include "picture_canvas.hpp"

namespace perch::app {

/// One line of what the colours of a panel mean.
struct LegendEntry {
  std::vector<Rgb> swatch;  ///< drawn side by side; many make a scale
  std::string text;
};

/// One of the images that stand side by side; all show the same window of the depth image.
struct Panel {
  std::string title;
  Image<Rgb> image;
  bool shows_objects = false;  ///< outlines and names of the objects belong on it
  std::vector<LegendEntry> legend;
};

/// Where an object is seen.
struct ObjectName {
  std::string text;          ///< the model's, numbered where there are several
  double u = 0.0, v = 0.0;   ///< a visible point near the middle of what is seen, pixels of the window
  Window seen;               ///< that holds all of it that is seen, pixels of the window
  std::int64_t visible = 0;  ///< pixels; 0: hidden, without a place
};

/// What the picture of a scene shows.
struct Panels {
  std::vector<Panel> panels;
  std::vector<Segment> outlines;  ///< between what belongs to different objects, in pixels of the window
  std::vector<ObjectName> names;  ///< of the result's objects, in order
  Image<std::uint32_t> objects;   ///< as in SceneRendering, of the window; empty without a scene
};

/// What panels are drawn on: the colour of pixels that show nothing.
inline constexpr Rgb panel_background{18, 21, 26};

/// The panels of a scene: observed (led by the colour image where there is one), rendered and residual.
/// \param rendering of the result's objects; nullptr where there is no scene: then only what was observed.
Panels make_panels(const Scene& scene, const Result& result, const SceneRendering* rendering);

/// A count with its thousands set apart by commas.
std::string grouped(std::int64_t count);

}  // namespace perch::app
