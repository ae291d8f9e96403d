#pragma once

#include <Eigen/Core>
#include <vector>

#include "perch/model/mesh.hpp"
#include "perch/model/model_symmetries.hpp"

namespace perch {

/// A way in which a thing rests on a plane by itself.
struct StablePose {
  Eigen::Vector3d up;  ///< what points up, model frame, unit length
  /// How likely it is to come to rest so when it is let go in any orientation, in (0, 1], see rest_poses.
  double share = 0.0;
};

/// How rest_poses looks for them.
struct RestPoseSettings {
  /// A face that a thing leaves for a lower one when its centre of mass is lifted by less than this is none
  /// to rest on; in diameters.
  double least_rise = 0.002;
  double least_share = 0.02;  ///< less likely ones are left out, but not upright
  std::size_t most = 12;      ///< the most likely ones are kept, and upright
  double tolerance = 0.0025;  ///< metres: what differs by less looks the same
};

/// The ways in which a thing rests on a plane: the faces of its convex hull (triangles within a thousandth
/// of the diameter of one plane are one face) that it does not tip over from. Its mass is spread evenly
/// through its volume, or for an open mesh through its hull.
///
/// How likely each is, is estimated as in Goldberg, Mirtich, Zhuang, Craig, Carlisle and Canny, "Part pose
/// statistics: estimators and experiments", 1999: each face is met with the solid angle at which the centre
/// of mass sees it; from a face that does not hold, the thing tips over the edge that holds least, until a
/// face holds. All shares sum to 1 before any pose is left out.
///
/// Poses in which the thing looks the same, but for a turn and a shift on the plane, are one, the likeliest
/// of them, with the sum of their shares: by the symmetries declared, or else by the shapes themselves. So
/// the sides of a lying solid of revolution are one pose. An up within half the tolerance (at the thing's
/// radius) of an axis of the model's frame is that axis.
///
/// Upright (+z) comes first where it is among them, the others by falling share.
///
/// Throws InputError, one clause without a name, for what has no volume: a flat mesh. Deterministic.
std::vector<StablePose> rest_poses(const Mesh& mesh, const ModelSymmetries& symmetries = {},
                                   const RestPoseSettings& settings = {});

}  // namespace perch
