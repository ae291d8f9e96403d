#pragma once

#include <filesystem>

#include "perch/core/camera.hpp"
#include "perch/core/image.hpp"
#include "perch/io/mesh_file.hpp"

namespace perch {

enum class CloudFrame {
  camera,  ///< the sensor's optical frame: x right, y down, z forward
  world
};

/// How the coordinates in a cloud's file are to be taken.
struct CloudReading {
  CloudFrame frame = CloudFrame::camera;
  LengthUnit unit = LengthUnit::metres;
};

/// The depth image, metres, that the camera sees of a PCD or PLY cloud. An organized cloud of the camera's
/// size, or any with a point for each pixel that lies there, gives each pixel its own point's depth; all
/// others are projected, the nearest point counts. In the camera frame, the sensor's pose in a PCD file
/// (VIEWPOINT) is taken off.
/// \param has_pose whether camera.world_from_camera is given.
/// Throws InputError (one line: file, what is wrong, the remedy that fits): an organized cloud whose points
/// don't lie on their pixels (median >= 1 pixel), any other of which less than half is in view, depths that
/// no depth camera has.
DepthImage read_cloud_depth(const std::filesystem::path& path, const CloudReading& reading,
                            const Camera& camera, bool has_pose);

}  // namespace perch
