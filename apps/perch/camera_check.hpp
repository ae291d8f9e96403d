#pragma once

#include <optional>
#include <string>

#include "inspection.hpp"

namespace perch::app {

/// Whether depth, camera pose, table height and workspace fit together and, where they don't, which usual
/// mistake would explain it: the pose given the wrong way round, in another axis convention, with z flipped,
/// or a depth scale off by a power of ten. \param plane of the readings, where there is one.
std::optional<Warning> check_camera(const Scene& scene, const std::optional<SeenPlane>& plane);

}  // namespace perch::app
