#pragma once

#include <filesystem>

#include "perch/io/point_cloud.hpp"

namespace perch {

/// The points of a PCD or PLY file, by its ending. Throws InputError (one line: file, what is wrong, remedy).
PointCloud read_cloud(const std::filesystem::path& path);

}  // namespace perch
