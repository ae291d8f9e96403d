#pragma once

#include <Eigen/Geometry>

#include "perch/model/mesh.hpp"

namespace perch {

/// One of the orientations in which a model may rest on the support plane.
struct RestPose {
  int index = 0;     ///< among its model's, from 0
  bool only = true;  ///< the model has no other
  /// Maps the model's own frame to the one in which it stands on z = 0 in this orientation.
  Eigen::Isometry3d stood_from_model = Eigen::Isometry3d::Identity();
};

/// The smallest rotation that takes `up` to +z; for -z, half a turn about x. The identity, to the bit, for
/// +z. \param up model frame, unit length.
Eigen::Matrix3d rotation_to_up(const Eigen::Vector3d& up);

/// What stands a model on z = 0 with `up` pointing up: rotation_to_up, then lifted or lowered until the
/// lowest point lies at z = 0; x and y are not shifted. The identity for +z and a mesh that stands already.
/// \param mesh model frame, metres, with a vertex. \param up model frame, unit length.
Eigen::Isometry3d stood_from_model(const Mesh& mesh, const Eigen::Vector3d& up);

/// The mesh in another frame: every vertex moved; the same to the bit for the identity.
Mesh transformed(Mesh mesh, const Eigen::Isometry3d& to_from_mesh);

}  // namespace perch
