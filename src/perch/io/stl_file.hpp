#pragma once

#include <string_view>

#include "perch/io/polygon_mesh.hpp"

namespace perch {

/// The triangles of an STL file, ASCII or binary. Throws FormatFault: a file that is incomplete or holds more
/// than its header says, a facet without three vertices, a vertex that is not finite. (Assimp 5.2 takes some
/// broken facets for whole and leaks on others.)
PolygonMesh read_stl(std::string_view bytes);

}  // namespace perch
