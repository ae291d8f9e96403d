#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "perch/model/mesh.hpp"
#include "perch/model/voxel_grid.hpp"
#include "perch/parallel/executor.hpp"

namespace perch {

/// How deep a point lies inside a mesh: a voxel field of the signed distance to the surface, in the model's
/// frame. Positive inside; an open mesh has no inside. Distances are to points sampled on the surface, so
/// every answer has a known error, and depth_lower_bound takes it off.
class SolidVolume {
 public:
  SolidVolume() = default;
  /// \param margin how far around the mesh the field reaches, metres.
  /// \param executor among whose workers the work is shared; the result is the same for any. Throws
  /// Interrupted when the stop condition strikes.
  SolidVolume(const Mesh& mesh, double margin, const Executor& executor = SerialExecutor(),
              const StopCondition& stop = StopCondition());

  /// True where the mesh is closed, so that it has an inside.
  bool is_solid() const { return solid_; }

  /// About the signed distance from p to the surface, metres, positive inside; -infinity outside the field.
  float signed_distance(const Eigen::Vector3f& p) const;
  /// Never more than how deep p lies inside the solid; -infinity where that is not known to be positive.
  float depth_lower_bound(const Eigen::Vector3f& p) const;
  /// The depth lies within [depth_lower_bound, depth_lower_bound + uncertainty()], for depths above
  /// uncertainty().
  float uncertainty() const { return 2.0F * (field_error_ + half_diagonal_); }

  /// The field itself, for loops that look up several points at a time: |value| at a voxel's centre differs
  /// from the distance there by at most field_error(). Voxel (i, j, k) is the one whose centre, origin +
  /// voxel (i, j, k), is nearest, and has the number (k size_y + j) size_x + i.
  struct Field {
    float voxel, origin_x, origin_y, origin_z;
    int size_x, size_y, size_z;
    const float* values;
  };
  Field field() const {
    return {grid_.voxel,    grid_.origin.x(), grid_.origin.y(), grid_.origin.z(),
            grid_.size.x(), grid_.size.y(),   grid_.size.z(),   field_.data()};
  }
  float field_error() const { return field_error_; }
  /// What lies outside the field is farther from the mesh's box than this, metres.
  float reach() const { return reach_; }

  /// Points on the surface such that every surface point has one within sample_radius().
  const std::vector<Eigen::Vector3f>& surface_samples() const { return samples_; }
  float sample_radius() const { return sample_radius_; }
  /// Points spread evenly through the inside, a few thousand at most; none for an open mesh.
  const std::vector<Eigen::Vector3f>& interior_samples() const { return interior_; }
  /// The deepest point's depth bound: objects shallower than a tolerance can't be entered beyond it.
  float greatest_depth() const { return greatest_depth_; }

 private:
  bool find_voxel(const Eigen::Vector3f& p, std::size_t& voxel, float& distance) const;
  void sample_interior(const std::vector<std::uint16_t>& winding);

  bool solid_ = false;
  VoxelGrid grid_;
  std::vector<float> field_;  ///< signed distance at the voxels' centres
  float field_error_ = 0.0F;
  float reach_ = 0.0F;
  float half_diagonal_ = 0.0F;
  std::vector<Eigen::Vector3f> samples_;
  float sample_radius_ = 0.0F;
  std::vector<Eigen::Vector3f> interior_;
  float greatest_depth_ = 0.0F;
};

}  // namespace perch
