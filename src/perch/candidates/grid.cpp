#include "perch/candidates/grid.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "perch/core/error.hpp"

namespace perch {
namespace {

constexpr double rounding = 1e-9;  // so that 0.48 / 0.04 steps are 12 and 360 / 22.5 degrees are 16

}  // namespace

void GridSettings::check() const {
  if (!std::isfinite(resolution) || resolution <= 0.0 || resolution > 100.0)
    throw InvalidSetting(
        fmt::format("grid.resolution is {}; it must lie above 0 and up to 100 metres", resolution));
  if (!std::isfinite(yaw_resolution) || yaw_resolution <= 0.0 ||
      yaw_resolution > 2.0 * std::numbers::pi + rounding)
    throw InvalidSetting(
        fmt::format("grid.yaw_resolution_deg is {}; it must lie above 0 and up to 360 degrees",
                    yaw_resolution * 180.0 / std::numbers::pi));
  if (max_poses < 1)
    throw InvalidSetting(fmt::format("grid.max_poses is {}; it must be at least 1", max_poses));
}

PoseGrid::PoseGrid(const Workspace& workspace, const GridSettings& settings, const Symmetry& symmetry)
    : step_(settings.resolution) {
  const double width = workspace.x_max - workspace.x_min, height = workspace.y_max - workspace.y_min;
  columns_ = std::floor(width / step_ + rounding) + 1.0;
  rows_ = std::floor(height / step_ + rounding) + 1.0;
  x0_ = workspace.x_min + 0.5 * (width - (columns_ - 1.0) * step_);
  y0_ = workspace.y_min + 0.5 * (height - (rows_ - 1.0) * step_);
  yaws_ = symmetry.is_continuous() ? 1.0 : std::ceil(symmetry.period() / settings.yaw_resolution - rounding);
  yaw_step_ = symmetry.is_continuous() ? 0.0 : symmetry.period() / yaws_;
}

Pose PoseGrid::pose(std::int64_t index) const {
  const auto yaws = static_cast<std::int64_t>(yaws_), columns = static_cast<std::int64_t>(columns_);
  const std::int64_t yaw = index % yaws, column = index / yaws % columns, row = index / yaws / columns;
  return {x0_ + static_cast<double>(column) * step_, y0_ + static_cast<double>(row) * step_,
          static_cast<double>(yaw) * yaw_step_};
}

}  // namespace perch
