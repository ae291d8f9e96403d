#include "perch/model/object_model.hpp"

#include <algorithm>

namespace perch {

ObjectModel::ObjectModel(std::string name, Mesh mesh, Symmetry symmetry, double origin_z, double margin,
                         const Executor& executor, const StopCondition& stop, const RestPose& rest)
    : name_(std::move(name)),
      mesh_(std::move(mesh)),
      symmetry_(symmetry),
      origin_z_(origin_z),
      rest_(rest),
      bounds_(mesh_.bounds()),
      height_(bounds_.max().z()),
      solid_(mesh_, margin, executor, stop) {
  for (const Eigen::Vector3f& p : mesh_.vertices) radius_ = std::max<double>(radius_, p.head<2>().norm());
}

Eigen::Isometry3d ObjectModel::world_from_unturned(const Pose& pose) const {
  const Eigen::Isometry3d world_from_stood = world_from_model(pose);
  // To the bit where nothing is turned: a product would lose the sign of zeros.
  if (rest_.stood_from_model.matrix() == Eigen::Matrix4d::Identity()) return world_from_stood;
  return world_from_stood * rest_.stood_from_model;
}

}  // namespace perch
