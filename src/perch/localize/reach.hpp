#pragma once

#include <cstdint>

#include "perch/core/image.hpp"
#include "perch/localize/scene.hpp"

namespace perch {

/// Which readings can be those of an object, wherever in the workspace it stands: non-zero where the point is
/// of interest by the scene's mask, no higher than the highest model's top, no lower than the lowest model's
/// foot and no farther from the workspace than the largest model reaches; all by `margin` more, metres. A
/// scene without a workspace has no bounds to the sides. \param scene with camera pose and table height.
Image<std::uint8_t> readings_in_reach(const Scene& scene, double table_height, double margin);

}  // namespace perch
