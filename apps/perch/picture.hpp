#pragma once

#include <string>

#include "perch/localize/rendering.hpp"
#include "perch/localize/result.hpp"
#include "perch/localize/scene.hpp"

namespace perch::app {

/// The bytes of a PNG file that shows a person what a result says: what was observed, the scene found, and
/// where they differ, side by side, with the costs below. At most about 2,000 pixels wide.
/// \param rendering of the result's objects; nullptr where there is no scene: then what was observed and why.
std::string draw_picture(const Scene& scene, const Result& result, const SceneRendering* rendering);

}  // namespace perch::app
