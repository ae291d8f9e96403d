#pragma once

#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"

namespace perch {

/// A scene whose background is the table, as one whose background is removed: finds the support plane, and
/// with it the camera's pose and the table's height where these are not given, and masks what stands on it.
///
/// Without a camera pose the world is the plane's: z its normal, height 0, the origin where the optical axis
/// meets it (below the camera where that is more than 3 m away), x the camera's x along the plane. A given
/// pose is used as it is, and a given height too, but for what is seen to be nearer than
/// PlaneSettings::height_range. Throws InputError where no plane is found.
Scene without_table(Scene scene, const PlaneSettings& settings);

}  // namespace perch
