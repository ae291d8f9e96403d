#pragma once

#include <cstddef>
#include <filesystem>

namespace perch {

/// The triangles that the meshes of a glTF 2 file (.gltf or .glb) promise, each mesh counted once however
/// often it is placed. The importer drops triangles that name missing vertices and says nothing; the promise
/// shows it. Throws FormatFault where the file's JSON can't be read.
std::size_t promised_triangles(const std::filesystem::path& path);

}  // namespace perch
