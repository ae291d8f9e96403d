#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "perch/model/mesh.hpp"

namespace perch {

/// How far points lie from the surface of a mesh. The triangles are cut into pieces no longer than a spacing,
/// a point's nearest pieces are found by their middles, and the distance is that to the triangles they are
/// of: never less than the exact one, and hardly ever more; by two thirds of the spacing at most.
class SurfaceDistance {
 public:
  /// Keeps a reference to the mesh, which must have a triangle. \param spacing metres, > 0; it is made larger
  /// where there would be more than a few hundred thousand pieces.
  SurfaceDistance(const Mesh& mesh, double spacing);
  ~SurfaceDistance();

  /// The distance, metres; or, once it is known to be no more than `enough`, some number up to that.
  double operator()(const Eigen::Vector3d& p, double enough) const;

 private:
  struct Tree;
  const Mesh& mesh_;
  std::vector<Eigen::Vector3f> middles_;    ///< of the pieces
  std::vector<std::uint32_t> triangle_of_;  ///< each piece is of
  std::unique_ptr<Tree> tree_;
};

}  // namespace perch
