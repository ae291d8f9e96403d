#pragma once

#include <Eigen/Geometry>
#include <string>

#include "perch/core/pose.hpp"
#include "perch/model/mesh.hpp"
#include "perch/model/rest_orientation.hpp"
#include "perch/model/solid_volume.hpp"
#include "perch/model/symmetry.hpp"

namespace perch {

/// A model as the method uses it: its surface, its solid, and how high its origin stands in the world.
class ObjectModel {
 public:
  /// \param mesh stood on z = 0, metres, without mesh_fault. \param origin_z world height of the mesh's z =
  /// 0. \param margin how far around the surface the solid's distance field must reach, metres.
  /// \param executor among whose workers the work is shared. \param rest which of the model's orientations
  /// the mesh is in. Throws Interrupted when the stop condition strikes.
  ObjectModel(std::string name, Mesh mesh, Symmetry symmetry, double origin_z, double margin,
              const Executor& executor = SerialExecutor(), const StopCondition& stop = StopCondition(),
              const RestPose& rest = RestPose());

  const std::string& name() const { return name_; }
  const Mesh& mesh() const { return mesh_; }
  const Symmetry& symmetry() const { return symmetry_; }
  const SolidVolume& solid() const { return solid_; }
  const RestPose& rest() const { return rest_; }
  double origin_z() const { return origin_z_; }
  /// Farthest surface point from the model's z axis, metres.
  double radius() const { return radius_; }
  double height() const { return height_; }
  /// Of the mesh, model frame, metres.
  const Eigen::AlignedBox3f& bounds() const { return bounds_; }

  Eigen::Isometry3d world_from_model(const Pose& pose) const {
    return perch::world_from_model(pose, origin_z_);
  }
  /// The same of the model's own frame, in which it is not turned to the orientation that it rests in.
  Eigen::Isometry3d world_from_unturned(const Pose& pose) const;

 private:
  std::string name_;
  Mesh mesh_;
  Symmetry symmetry_;
  double origin_z_;
  RestPose rest_;
  Eigen::AlignedBox3f bounds_;
  double radius_ = 0.0, height_ = 0.0;
  SolidVolume solid_;
};

}  // namespace perch
