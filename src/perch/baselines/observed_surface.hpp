#pragma once

#include "perch/observation/observation.hpp"
#include "perch/parallel/executor.hpp"
#include "perch/refine/surface_samples.hpp"

namespace perch {

/// The points of I with normals, world frame: of the plane that fits best (least squares, by the eigenvectors
/// of the covariance) to the points of I within `radius` (metres) that are seen beside, turned to the camera.
/// Points with fewer than 8 such neighbours are left out. Throws Interrupted.
SurfaceSamples observed_surface(const Observation& observation, double radius, const Executor& executor,
                                const StopCondition& stop);

}  // namespace perch
