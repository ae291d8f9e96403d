#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "perch/model/mesh.hpp"

namespace perch {

/// The unit of the lengths in a mesh file.
enum class LengthUnit { metres, millimetres };

/// "m" or "mm"; empty for anything else.
std::optional<LengthUnit> parse_length_unit(std::string_view word);

/// Reads a triangle mesh from a PLY, OBJ, STL, GLB or glTF file, told apart by the file's ending. Node
/// transforms are applied, polygons cut into triangles, points and lines dropped, vertices at the same place
/// joined. The axes stay as in the file (glTF's own convention of y up is not turned). Metres.
/// Throws InputError, one line: file, what is wrong, remedy. Refused are also meshes of more than 5 m or less
/// than 1 mm, which have mostly been read in the wrong unit. \param unit_key what the remedy tells to set.
Mesh read_mesh(const std::filesystem::path& path, LengthUnit unit, const std::string& unit_key = "unit");

}  // namespace perch
