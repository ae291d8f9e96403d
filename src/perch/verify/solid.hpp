#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "perch/model/mesh.hpp"
#include "perch/verify/ray_mesh.hpp"

namespace perch {

/// A mesh as a solid: what lies inside, how deep, and points on and in it. An open mesh has no inside.
class Solid {
 public:
  /// \param mesh model frame, metres.
  explicit Solid(const Mesh& mesh);

  /// True where every edge is run along equally often in both directions, so that the mesh bounds a solid.
  bool is_closed() const { return closed_; }
  const Eigen::AlignedBox3d& bounds() const { return bounds_; }

  /// True only where rays in several directions agree that the surface winds around p.
  bool is_inside(const Eigen::Vector3d& p) const;
  /// From p to the surface, metres.
  double distance(const Eigen::Vector3d& p) const { return rays_.distance(p); }
  /// True where p lies more than `depth` metres (>= 0) below the surface.
  bool is_deeper(const Eigen::Vector3d& p, double depth) const {
    return bounds_.contains(p) && !rays_.is_within(p, depth) && is_inside(p);
  }

  /// Points on the surface: the vertices, and more where they are farther apart than a hundredth of the
  /// solid's longest side or 1 mm.
  const std::vector<Eigen::Vector3d>& surface_points() const { return surface_; }
  /// At most 4,000 points spread at random, but always the same, through the inside; none for an open mesh.
  const std::vector<Eigen::Vector3d>& interior_points() const { return interior_; }
  /// The side of the voxels by which perch measures how deep a point lies in this solid, metres.
  double voxel() const;

 private:
  void sample_surface();
  void sample_interior();

  std::vector<Eigen::Vector3d> vertices_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  Eigen::AlignedBox3d bounds_;
  bool closed_;
  RayMesh rays_;
  std::vector<Eigen::Vector3d> surface_, interior_;
};

/// A solid that stands somewhere.
struct PlacedSolid {
  const Solid* solid;
  Eigen::Isometry3d world_from_model;
};

/// What two solids share, at least.
struct Overlap {
  double depth = 0.0;  ///< how deep a surface point of one was found in the other, metres
  double share =
      0.0;  ///< the larger of the shares of one that lie in the other, less four standard deviations
};
Overlap overlap_of(const PlacedSolid& a, const PlacedSolid& b);

/// By how much more than collision.penetration solids may enter each other before perch must see it, metres:
/// it looks at points of one surface that are a few voxels apart, and knows how deep they lie to a few voxels
/// of the other.
double depth_slack(const Solid& a, const Solid& b);
/// The same for the share of collision.overlap, which perch counts on a lattice of voxels.
constexpr double share_slack = 0.05;

}  // namespace perch
