#pragma once

#include <optional>

#include "perch/observation/observation.hpp"
#include "perch/render/rasterizer.hpp"
#include "perch/sim/parametric_models.hpp"

namespace perch {

/// A mug 0.8 m away, seen from above, as observed and as rendered 3 mm aside. The world frame is the
/// camera's.
struct ObservedMug {
  Camera camera;
  Mesh mesh = mug_mesh();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity(), aside;
  Rasterizer rasterizer;
  DepthImage depth;  ///< of the camera
  Observation observation;
  DepthPatch rendered;  ///< aside

  explicit ObservedMug(double focal = 525.0)
      : camera{{640, 480, focal, focal, 319.5, 239.5}, Eigen::Isometry3d::Identity()},
        pose(Eigen::Translation3d(0.0, 0.03, 0.8) * Eigen::AngleAxisd(2.2, Eigen::Vector3d::UnitX())),
        aside(Eigen::Translation3d(0.003, 0.0, 0.002) * pose),
        rasterizer(camera.intrinsics),
        depth(seen(rasterizer.render(mesh, pose))),
        observation(camera, depth, std::nullopt),
        rendered(rasterizer.render(mesh, aside)) {}

 private:
  DepthImage seen(const DepthPatch& patch) const {
    DepthImage image(camera.intrinsics.width, camera.intrinsics.height);
    for (int v = patch.window.v0; v < patch.window.v1; ++v)
      for (int u = patch.window.u0; u < patch.window.u1; ++u)
        if (patch.at(u, v) < no_surface) image(u, v) = patch.at(u, v);
    return image;
  }
};

}  // namespace perch
