#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "perch/core/camera.hpp"
#include "perch/core/image.hpp"

namespace perch {

/// A point that is not finite, or all zero, is no reading.
using CloudPoints = std::vector<Eigen::Vector3d>;

/// How far the points of an organized cloud lie from the pixels they stand for, median over the readings,
/// pixels; one that is not in front of the camera lies infinitely far away. Infinity without a reading.
/// \param points one a pixel, row by row. \param every looks at each so-many-th reading only.
double median_pixel_error(const CloudPoints& points, const Eigen::Affine3d& camera_from_points,
                          const Intrinsics& intrinsics, std::size_t every = 1);

/// The depth of each point at the pixel it stands for, rounded to float once; 0 where there is no reading or
/// it is not in front of the camera. \param points as for median_pixel_error.
DepthImage depth_of_organized(const CloudPoints& points, const Eigen::Affine3d& camera_from_points,
                              const Intrinsics& intrinsics);

struct CloudProjection {
  DepthImage depth;          ///< of the nearest point at each pixel, whatever the points' order
  std::size_t readings = 0;  ///< points
  std::size_t in_view = 0;   ///< of these, in front of the camera and inside the image
};

/// Sees any cloud through the camera: each point counts at the pixel whose centre is nearest to its image.
CloudProjection project_cloud(const CloudPoints& points, const Eigen::Affine3d& camera_from_points,
                              const Intrinsics& intrinsics, std::size_t every = 1);

/// The intrinsics, size aside, with which the points of an organized cloud come nearest to their pixels, by
/// least squares. \param points as for median_pixel_error, at least two readings not on one line through the
/// camera's axis; else what is returned is not finite.
Intrinsics fitted_intrinsics(const CloudPoints& points, const Intrinsics& size);

}  // namespace perch
