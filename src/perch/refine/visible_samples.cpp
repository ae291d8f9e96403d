#include "perch/refine/visible_samples.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "perch/core/instruction_set.hpp"

namespace perch {
namespace {

struct VisibleFrame {
  std::size_t samples;
  const float* from[6];  ///< x, y, z, nx, ny, nz; model frame
  float camera[3][3], camera_shift[3];
  float world[3][3], world_shift[3];
  float fx, fy, cx, cy;  ///< half a pixel more, so that cutting off gives the nearest pixel
  int width, height;
  float occlusion;
  const DepthPatch* in_front;
  const Observation* observation;
};

struct SampleArrays {
  float* values[6];
};

void copy(const Eigen::Isometry3d& transform, float (&matrix)[3][3], float (&shift)[3]) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) matrix[i][j] = static_cast<float>(transform.linear()(i, j));
    shift[i] = static_cast<float>(transform.translation()[i]);
  }
}

}  // namespace
}  // namespace perch

#define PERCH_KERNELS "perch/refine/visible_samples.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {

void visible_samples(const SurfaceSamples& view, const Pose& pose, double origin_z,
                     const DepthPatch* in_front, const Observation& observation, double occlusion,
                     SurfaceSamples& samples, Sight& sight) {
  const Intrinsics& intrinsics = observation.intrinsics();
  const Eigen::Isometry3d world_from_model = perch::world_from_model(pose, origin_z);
  VisibleFrame frame{
      view.size(),
      {view.x.data(), view.y.data(), view.z.data(), view.nx.data(), view.ny.data(), view.nz.data()},
      {},
      {},
      {},
      {},
      static_cast<float>(intrinsics.fx),
      static_cast<float>(intrinsics.fy),
      static_cast<float>(intrinsics.cx) + 0.5F,
      static_cast<float>(intrinsics.cy) + 0.5F,
      intrinsics.width,
      intrinsics.height,
      static_cast<float>(occlusion),
      in_front,
      &observation};
  copy(observation.camera().world_from_camera.inverse() * world_from_model, frame.camera, frame.camera_shift);
  copy(world_from_model, frame.world, frame.world_shift);
  samples.resize(view.size());
  const SampleArrays to{{samples.x.data(), samples.y.data(), samples.z.data(), samples.nx.data(),
                         samples.ny.data(), samples.nz.data()}};
  samples.resize(PERCH_CALL(select_visible, frame, to, sight));
}

}  // namespace perch
