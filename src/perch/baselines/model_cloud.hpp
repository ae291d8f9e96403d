#pragma once

#include <cstddef>

#include "perch/core/pose.hpp"
#include "perch/model/mesh.hpp"
#include "perch/refine/surface_samples.hpp"

namespace perch {

/// Points of a mesh's whole surface, inner and hidden parts included, with the triangles' normals (of closed
/// meshes outwards): as many on each part as is its share of the area. The same at every call: a point for
/// every equal step of the area, placed in its triangle by a low-discrepancy sequence (Roberts' R2). Empty
/// for a mesh without area.
SurfaceSamples model_cloud(const Mesh& mesh, std::size_t points);

/// The same points for an object at a pose, world frame. \param origin_z height of the model's origin,
/// metres.
SurfaceSamples placed(const SurfaceSamples& samples, const Pose& pose, double origin_z);

/// Points of these such that no two with normals less than 30 degrees apart lie nearer than `spacing`
/// (metres), and each left out is that near to one of them: the first come first.
SurfaceSamples thinned(const SurfaceSamples& samples, float spacing);

}  // namespace perch
