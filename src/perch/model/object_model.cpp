#include "perch/model/object_model.hpp"

#include <algorithm>

namespace perch {

ObjectModel::ObjectModel(std::string name, Mesh mesh, Symmetry symmetry, double origin_z, double margin,
                         const Executor& executor, const StopCondition& stop)
    : name_(std::move(name)),
      mesh_(std::move(mesh)),
      symmetry_(symmetry),
      origin_z_(origin_z),
      bounds_(mesh_.bounds()),
      height_(bounds_.max().z()),
      solid_(mesh_, margin, executor, stop) {
  for (const Eigen::Vector3f& p : mesh_.vertices) radius_ = std::max<double>(radius_, p.head<2>().norm());
}

}  // namespace perch
