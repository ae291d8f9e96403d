#pragma once

#include <string_view>

#include "perch/io/polygon_mesh.hpp"

namespace perch {

/// The polygons of a PLY file, ASCII or binary. Throws FormatFault: a header that promises more than the file
/// holds, a face that names a missing vertex, a vertex that is not finite. (Assimp 5.2 takes a first data
/// byte of a binary body that looks like a line end for one, shifts all that follows and says nothing.)
PolygonMesh read_ply(std::string_view bytes);

}  // namespace perch
