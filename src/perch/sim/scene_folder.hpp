#pragma once

#include <filesystem>
#include <string>

#include "perch/model/mesh.hpp"
#include "perch/sim/simulated_scene.hpp"

namespace perch {

/// The bytes of a binary little-endian PLY file: positions as float32, triangles as int32.
std::string encode_ply(const Mesh& mesh);

/// The shortest text that reads back as the same double; never -0.
std::string exact_number(double value);

/// The text of a scene file with its truth, for people to read: `comment` (lines of at most 110 characters)
/// at its head, and beside each true pose how much of the object is visible. Numbers read back as the same
/// doubles. A scene with a mask names mask.png. \param model_folder relative to the file.
std::string scene_yaml(const SimulatedScene& simulated, const std::string& comment,
                       const std::string& model_folder = "models");

/// Writes a scene as a folder: scene.yaml, depth.png at the scene's depth scale, and models/NAME.ply. Throws
/// InputError where it can't be written.
void write_scene_folder(const std::filesystem::path& folder, const SimulatedScene& simulated,
                        const std::string& comment);

}  // namespace perch
