#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "perch/model/mesh.hpp"

namespace perch {

/// What a depth camera sees of an object that stands alone.
struct ObjectView {
  std::vector<Eigen::Vector3f> points;  ///< camera frame, metres, one a pixel
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
};

/// Renders a mesh from one side, without noise. The camera looks at the middle of the mesh's bounds and
/// stands upright as the model does; looking straight up or down, its right is the model's x. \param
/// direction unit vector from the object to the camera, model frame. \param distance of the camera from the
/// middle, metres; farther for an object so large that it would not leave room. \param spacing of the pixels
/// at the middle, metres.
ObjectView view_object(const Mesh& mesh, const Eigen::Vector3d& direction, double distance, double spacing);

}  // namespace perch
