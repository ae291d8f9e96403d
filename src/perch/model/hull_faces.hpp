#pragma once

#include <Eigen/Core>
#include <vector>

#include "perch/model/mesh.hpp"

namespace perch {

/// A face of a convex hull, which a body may lie on.
struct HullFace {
  Eigen::Vector3d normal;    ///< outwards, unit length
  double height = 0.0;       ///< of the centre of mass above the face, metres
  double solid_angle = 0.0;  ///< at which the centre of mass sees it, steradians
  /// An edge, and the face beyond it.
  struct Edge {
    std::size_t face = 0;
    double rise = 0.0;  ///< by how much the centre of mass is to be lifted until the body falls over the
                        ///< edge, metres; negative where it falls by itself
  };
  std::vector<Edge> edges;
};

/// The faces of a hull. Triangles whose corners lie within `flatness` (metres) of the plane of a larger one
/// beside them are one face with it. \param hull closed and convex. \param centre inside it, metres.
std::vector<HullFace> hull_faces(const Mesh& hull, const Eigen::Vector3d& centre, double flatness);

}  // namespace perch
