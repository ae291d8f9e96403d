#pragma once

#include <Eigen/Core>

#include "perch/model/mesh.hpp"

namespace perch {

/// The convex hull of a mesh's vertices, by Qhull (Barber, Dobkin and Huhdanpaa 1996): triangles that face
/// outwards over those of the vertices that are corners of it. Throws InputError, one clause without a file
/// name, where there is none: fewer than four vertices, or all of them in a plane or nearly so.
Mesh convex_hull(const Mesh& mesh);

/// The volume that a closed mesh bounds, cubic metres, and its centroid, by the divergence theorem. Positive
/// where the triangles face outwards; the centroid means nothing where the volume is 0.
struct VolumeCentroid {
  double volume = 0.0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
};
VolumeCentroid volume_centroid(const Mesh& mesh);

/// The largest distance of any two of the vertices, metres. \param hull a convex hull, whose vertices are
/// few.
double hull_diameter(const Mesh& hull);

}  // namespace perch
