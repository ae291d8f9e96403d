#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "perch/core/camera.hpp"
#include "perch/model/mesh.hpp"

namespace perch {

/// Depths on a pixel's ray, metres along the optical axis.
struct DepthRange {
  double near = 0.0, far = 0.0;
};

/// A range of depths that an object's nearest surface may have at a pixel, as far as rounding lets anyone
/// say. Most pixels have one that is micrometres long; where an outline runs through the pixel's centre there
/// are several, or the object may be missed.
struct Sighting {
  std::uint32_t pixel = 0;  ///< row-major
  std::uint32_t object = 0;
  DepthRange depth;
  bool may_miss = false;  ///< the same for all of an object's sightings at a pixel
};

/// What lies nearer to the camera's plane than this is cut off, metres.
constexpr double sight_near_plane = 0.01;

/// What a renderer in single precision that samples at pixel centres may see of an object that stands alone:
/// by ascending pixel, near ranges first. Holds for any such renderer that leaves no cracks, draws both faces
/// and cuts off at the near plane. \param mesh model frame. \param object copied to every sighting.
std::vector<Sighting> sightings(const Mesh& mesh, const Eigen::Isometry3d& camera_from_model,
                                const Intrinsics& intrinsics, std::uint32_t object);

}  // namespace perch
