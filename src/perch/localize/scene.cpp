#include "perch/localize/scene.hpp"

#include "perch/model/rest_orientation.hpp"

namespace perch {

std::vector<SceneModel> bodies_of(const SceneModel& upright, const std::vector<Eigen::Vector3d>& ups) {
  std::vector<SceneModel> bodies;
  for (const Eigen::Vector3d& up : ups) {
    SceneModel body = upright;
    body.rest_pose = static_cast<int>(bodies.size());
    body.up = up;
    body.stood_from_model = stood_from_model(upright.mesh, up);
    body.mesh = transformed(upright.mesh, body.stood_from_model);
    if (rotation_to_up(up).col(2).cwiseAbs() != Eigen::Vector3d::UnitZ()) body.symmetry = Symmetry::none();
    bodies.push_back(std::move(body));
  }
  return bodies;
}

}  // namespace perch
