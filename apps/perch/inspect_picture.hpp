#pragma once

#include <string>

#include "inspection.hpp"

namespace perch::app {

/// The bytes of a PNG file: the depth image with what counts as objects, the plane with the workspace on it,
/// and each model once in the workspace as the camera would see it.
/// \param raw as read. \param scene prepared, where that was possible.
std::string draw_inspection(const Scene& raw, const Scene& scene, const Inspection& found);

}  // namespace perch::app
