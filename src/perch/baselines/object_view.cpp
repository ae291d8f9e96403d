#include "perch/baselines/object_view.hpp"

#include <algorithm>
#include <cmath>

#include "perch/render/rasterizer.hpp"

namespace perch {

ObjectView view_object(const Mesh& mesh, const Eigen::Vector3d& direction, double distance, double spacing) {
  constexpr int largest_image = 2048;  // pixels: of a huge object fewer points are seen
  const Eigen::AlignedBox3d bounds = mesh.bounds().cast<double>();
  const double reach = 0.5 * bounds.diagonal().norm();
  const double eye = std::max(distance, 2.0 * reach);

  Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(direction);
  right =
      right.norm() > 1e-6 ? Eigen::Vector3d(right.normalized()) : Eigen::Vector3d(Eigen::Vector3d::UnitX());
  Eigen::Isometry3d model_from_camera = Eigen::Isometry3d::Identity();
  model_from_camera.linear().col(0) = right;
  model_from_camera.linear().col(1) = right.cross(direction);  // down
  model_from_camera.linear().col(2) = -direction;
  model_from_camera.translation() = bounds.center() + eye * direction;

  // A ball around the object just fits into the image.
  const double slope = reach / std::sqrt(eye * eye - reach * reach);
  const double focal = std::min(eye / spacing, 0.5 * largest_image / slope);
  const int size = std::clamp(2 * static_cast<int>(std::ceil(focal * slope)) + 4, 8, largest_image);
  const double middle = 0.5 * (size - 1);
  const Intrinsics intrinsics{size, size, focal, focal, middle, middle};
  ObjectView view{{}, model_from_camera.inverse()};
  const DepthPatch patch = Rasterizer(intrinsics).render(mesh, view.camera_from_model);
  const RaySlopes rays(intrinsics);
  for (int v = patch.window.v0; v < patch.window.v1; ++v)
    for (int u = patch.window.u0; u < patch.window.u1; ++u)
      if (const float z = patch.at(u, v); z < no_surface) view.points.push_back(rays.point(u, v, z));
  return view;
}

}  // namespace perch
