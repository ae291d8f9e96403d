#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "perch/core/camera.hpp"

namespace perch {

/// A vertex in the camera frame, metres, and where it projects, pixels.
struct alignas(32) ProjectedVertex {
  float x, y, z, u, v;
};

/// What a set of projected vertices covers.
struct ProjectedBounds {
  float u_min, v_min, u_max, v_max;  ///< of the vertices at or beyond the near plane
  bool crosses_near;                 ///< some vertex is nearer than the near plane; its u, v mean nothing
};

/// Projects one point of the camera frame, by the same operations as all.
ProjectedVertex project(const Eigen::Vector3f& point, const Intrinsics& intrinsics);

/// Moves vertices into the camera frame and projects them. `out` is resized.
ProjectedBounds project_all(const std::vector<Eigen::Vector3f>& vertices,
                            const Eigen::Isometry3d& camera_from_model, const Intrinsics& intrinsics,
                            float near_plane, std::vector<ProjectedVertex>& out);

}  // namespace perch
