#include "perch/candidates/explained_bound.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "perch/core/instruction_set.hpp"
#include "perch/render/rasterizer.hpp"

namespace perch {
namespace {

struct NearFrame {
  const float *x, *y, *z, *radius;  ///< of the blocks
  float r[9], t[3];                 ///< model from camera
  SolidVolume::Field field;
  float limit;   ///< farther from the surface than this, nothing is explained
  float beyond;  ///< a ball outside the field with a smaller radius is farther than that
};

}  // namespace
}  // namespace perch

#define PERCH_KERNELS "perch/candidates/explained_bound.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {

Window ExplainedBound::window(const ObjectModel& model, const Eigen::Isometry3d& camera_from_model) const {
  const Eigen::AlignedBox3d box = model.bounds().cast<double>();
  Eigen::AlignedBox2d seen;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p =
        camera_from_model * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
    if (!(p.z() >= static_cast<double>(Rasterizer::near_plane))) return intrinsics_.window();
    seen.extend(Eigen::Vector2d(intrinsics_.fx * p.x() / p.z() + intrinsics_.cx,
                                intrinsics_.fy * p.y() / p.z() + intrinsics_.cy));
  }
  const auto pixel = [](double x, int limit) {
    return static_cast<int>(std::clamp(x, -2.0, static_cast<double>(limit) + 2.0));
  };
  // A pixel more on each side for what rounding moves.
  return intersection(intrinsics_.window(), {pixel(std::floor(seen.min().x()), intrinsics_.width) - 1,
                                             pixel(std::floor(seen.min().y()), intrinsics_.height) - 1,
                                             pixel(std::ceil(seen.max().x()), intrinsics_.width) + 2,
                                             pixel(std::ceil(seen.max().y()), intrinsics_.height) + 2});
}

std::vector<Run> ExplainedBound::blocks(const ObjectModel& model,
                                        const Eigen::Isometry3d& camera_from_model) const {
  // Of coordinates in float, metres.
  const float rounding = 1e-5F * std::max(1.0F, static_cast<float>(camera_from_model.translation().norm()));
  Window around = window(model, camera_from_model);
  if (around.empty()) return {};
  const int margin = reach_ + 2;
  around = {around.u0 - margin, around.v0 - margin, around.u1 + margin, around.v1 + margin};
  const Eigen::Isometry3f model_from_camera = camera_from_model.inverse().cast<float>();
  const SolidVolume& solid = model.solid();
  NearFrame frame{blocks_.x().data(),
                  blocks_.y().data(),
                  blocks_.z().data(),
                  blocks_.radius().data(),
                  {},
                  {},
                  solid.field(),
                  delta_ + solid.field_error() + rounding,
                  solid.reach() - delta_ - rounding};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) frame.r[3 * i + j] = model_from_camera.linear()(i, j);
    frame.t[i] = model_from_camera.translation()[i];
  }
  std::vector<Run> near;
  blocks_.for_each_range(around, [&](const PointBlocks::Range& range) {
    PERCH_CALL(append_near, frame, range.first, range.last, near);
  });
  return near;
}

}  // namespace perch
