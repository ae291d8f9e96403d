#pragma once

#include <cstddef>

#include "perch/localize/scene.hpp"

namespace perch {

/// The same surface in at least so many triangles (as it is where it has them): the longest edge is halved
/// again and again, in all triangles that share it, so that closed meshes stay closed.
Mesh with_triangles(const Mesh& mesh, std::size_t triangles);

/// The same view in a larger image: the objects cover as many pixels as before, in its middle, and there is
/// nothing around them. Throws InvalidSetting where the image would become smaller.
Scene padded(Scene scene, int width, int height);

}  // namespace perch
