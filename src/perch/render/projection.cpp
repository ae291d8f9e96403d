#include "perch/render/projection.hpp"

#include <algorithm>
#include <limits>

#include "perch/core/instruction_set.hpp"

namespace perch {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

struct ProjectionMatrix {
  float r[3][3], t[3], fx, fy, cx, cy;
};

}  // namespace
}  // namespace perch

#define PERCH_KERNELS "perch/render/projection.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {

ProjectedVertex project(const Eigen::Vector3f& point, const Intrinsics& intrinsics) {
  const float inverse = 1.0F / point.z();
  return {point.x(), point.y(), point.z(),
          static_cast<float>(intrinsics.fx) * point.x() * inverse + static_cast<float>(intrinsics.cx),
          static_cast<float>(intrinsics.fy) * point.y() * inverse + static_cast<float>(intrinsics.cy)};
}

ProjectedBounds project_all(const std::vector<Eigen::Vector3f>& vertices,
                            const Eigen::Isometry3d& camera_from_model, const Intrinsics& intrinsics,
                            float near_plane, std::vector<ProjectedVertex>& out) {
  const Eigen::Matrix3f rotation = camera_from_model.linear().cast<float>();
  const Eigen::Vector3f translation = camera_from_model.translation().cast<float>();
  ProjectionMatrix matrix;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) matrix.r[i][j] = rotation(i, j);
    matrix.t[i] = translation[i];
  }
  matrix.fx = static_cast<float>(intrinsics.fx);
  matrix.fy = static_cast<float>(intrinsics.fy);
  matrix.cx = static_cast<float>(intrinsics.cx);
  matrix.cy = static_cast<float>(intrinsics.cy);
  out.resize(vertices.size());
  ProjectedBounds bounds{infinity, infinity, -infinity, -infinity, false};
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  if (!vertices.empty())
    PERCH_CALL(project_range, vertices.front().data(), vertices.size(), matrix, near_plane, out.data(),
               bounds);
  return bounds;
}

}  // namespace perch
