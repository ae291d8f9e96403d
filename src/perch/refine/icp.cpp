#include "perch/refine/icp.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "perch/core/error.hpp"
#include "perch/core/instruction_set.hpp"

namespace perch {
namespace {

/// What one pass over the samples goes by.
struct AlignFrame {
  NearestTable::Cells cells;
  std::size_t samples;
  const float *x, *y, *z, *nx, *ny, *nz;
  float pose_x, pose_y;    ///< where the samples belong
  float moved_x, moved_y;  ///< where they are now
  float cosine, sine;      ///< of the yaw gained
  float reach_squared, robust_scale;
  float turn;  ///< 1 / arm, or 0 where the yaw is fixed
};

/// Sums over the samples; x, y and t (the turn) name the components of the jacobian.
struct AlignSums {
  double xx, xy, xt, yy, yt, tt;  ///< of weight times jacobian times its transpose
  double x, y, t;                 ///< of weight times residual times jacobian
  double weight;
  std::size_t matched;
};

}  // namespace
}  // namespace perch

#define PERCH_KERNELS "perch/refine/icp.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {

void RefineSettings::check() const {
  const auto in_range = [](const char* field, double value, double low, double high, const char* unit) {
    if (!(value >= low && value <= high))
      throw InvalidSetting(
          fmt::format("refine.{} is {}; it must lie between {} and {}{}", field, value, low, high, unit));
  };
  if (reach) in_range("reach", *reach, 1e-6, largest_reach, " metres");
  in_range("rounds", rounds, 1, 100, "");
  in_range("iterations", iterations, 1, 1000, "");
  in_range("samples", samples, 10, 1e6, "");
  in_range("least_matched", least_matched, 0.0, 1.0, "");
  in_range("robust_scale", robust_scale, 1e-6, 1.0, " metres");
  in_range("occlusion", occlusion, 0.0, 10.0, " metres");
}

namespace {

/// The greatest distance of a sample from the object's axis.
double longest_arm(const SurfaceSamples& samples, const Pose& pose) {
  double most = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double x = static_cast<double>(samples.x[i]) - pose.x,
                 y = static_cast<double>(samples.y[i]) - pose.y;
    most = std::max(most, x * x + y * y);
  }
  return std::sqrt(most);
}

}  // namespace

Alignment align(const SurfaceSamples& samples, const Pose& pose, bool fix_yaw, const NearestTable& observed,
                double reach, const RefineSettings& settings) {
  // Metres, also at the arm's end of a turn. Smaller steps go on along what little an occluded surface says,
  // away from the pose as often as towards it.
  constexpr double smallest_step = 2e-4;
  constexpr double damping =
      1e-2;  // of the points' weight: holds what the visible surface leaves undetermined
  const double arm = longest_arm(samples, pose);
  Alignment found{pose};
  if (arm == 0.0) return found;
  AlignFrame frame{observed.cells(),
                   samples.size(),
                   samples.x.data(),
                   samples.y.data(),
                   samples.z.data(),
                   samples.nx.data(),
                   samples.ny.data(),
                   samples.nz.data(),
                   static_cast<float>(pose.x),
                   static_cast<float>(pose.y),
                   0.0F,
                   0.0F,
                   1.0F,
                   0.0F,
                   static_cast<float>(reach * reach),
                   static_cast<float>(settings.robust_scale),
                   fix_yaw ? 0.0F : static_cast<float>(1.0 / arm)};
  const double least = settings.least_matched * static_cast<double>(samples.size());
  Pose& moved = found.pose;
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    frame.moved_x = static_cast<float>(moved.x);
    frame.moved_y = static_cast<float>(moved.y);
    frame.cosine = static_cast<float>(std::cos(moved.yaw - pose.yaw));
    frame.sine = static_cast<float>(std::sin(moved.yaw - pose.yaw));
    AlignSums sums;
    PERCH_CALL(sum_up, frame, sums);
    found.misfit = 1.0 - sums.weight / static_cast<double>(samples.size());
    if (sums.matched == 0 || (iteration == 0 && static_cast<double>(sums.matched) < least)) break;
    Eigen::Matrix3d normal_matrix;
    normal_matrix << sums.xx, sums.xy, sums.xt, sums.xy, sums.yy, sums.yt, sums.xt, sums.yt, sums.tt;
    normal_matrix.diagonal().array() += damping * sums.weight;
    const Eigen::Vector3d step = -normal_matrix.ldlt().solve(Eigen::Vector3d(sums.x, sums.y, sums.t));
    moved.x += step.x();
    moved.y += step.y();
    moved.yaw += fix_yaw ? 0.0 : step.z() / arm;
    if (step.norm() < smallest_step) break;
  }
  return found;
}

double mean_residual(const SurfaceSamples& samples, const NearestTable& observed, double limit) {
  if (samples.empty()) return 1.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3f point = samples.point(i);
    const Eigen::Vector3f* q = observed.lookup(point);
    const double e = q == nullptr ? limit : std::abs(static_cast<double>(samples.normal(i).dot(point - *q)));
    sum += std::min(1.0, e / limit);
  }
  return sum / static_cast<double>(samples.size());
}

}  // namespace perch
