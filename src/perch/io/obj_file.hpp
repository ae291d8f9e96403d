#pragma once

#include <string_view>

#include "perch/io/polygon_mesh.hpp"

namespace perch {

/// The polygons of a Wavefront OBJ file; materials, normals, points, lines and free-form surfaces are passed
/// over. Throws FormatFault: a face that names a missing vertex, a vertex that is not finite, a broken line.
/// (Assimp 5.2 crashes on some broken vertex lines.)
PolygonMesh read_obj(std::string_view bytes);

}  // namespace perch
