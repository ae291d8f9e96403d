#include "perch/io/cloud_depth_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "perch/core/error.hpp"
#include "perch/io/cloud_file.hpp"
#include "perch/io/message.hpp"
#include "perch/observation/cloud_depth.hpp"

namespace perch {
namespace {

constexpr double largest_pixel_error = 1.0;
constexpr double smallest_share_in_view = 0.5;
constexpr double nearest_depth = 0.05, farthest_depth = 50.0;  // metres; of the median reading

struct Axes {
  const char* meaning;
  Eigen::Matrix3d optical_from_axes;
};

/// The other conventions that clouds come in.
std::vector<Axes> other_axes() {
  Eigen::Matrix3d forward_left_up, right_up_back;
  forward_left_up << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  right_up_back << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return {{"x forward, y left, z up", forward_left_up}, {"x right, y up, z backward", right_up_back}};
}

/// A way to take the coordinates, and what a user is to do who meant it.
struct Interpretation {
  Eigen::Affine3d camera_from_file = Eigen::Affine3d::Identity();
  std::string remedy;
};

Eigen::Affine3d camera_from_file(const PointCloud& cloud, const CloudReading& reading, const Camera& camera) {
  const double metres = reading.unit == LengthUnit::metres ? 1.0 : 0.001;
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (reading.frame == CloudFrame::world) {
    transform = camera.world_from_camera.inverse() * Eigen::Scaling(metres);
  } else {
    if (!cloud.file_from_sensor.isApprox(Eigen::Isometry3d::Identity(), 0.0))
      transform = cloud.file_from_sensor.inverse();
    transform = Eigen::Scaling(metres) * transform;
  }
  return transform;
}

/// What may have been meant in place of what was said, the likeliest first.
std::vector<Interpretation> other_interpretations(const PointCloud& cloud, const CloudReading& given,
                                                  const Camera& camera, bool has_pose) {
  std::vector<Interpretation> out;
  const auto add = [&](const Eigen::Affine3d& transform, std::string remedy) {
    Interpretation& added = out.emplace_back();
    added.camera_from_file = transform;
    added.remedy = std::move(remedy);
  };
  const auto metres = [](LengthUnit unit) {
    return Eigen::Scaling(unit == LengthUnit::metres ? 1.0 : 0.001);
  };
  const Eigen::Affine3d as_given = camera_from_file(cloud, given, camera);
  const CloudFrame other_frame = given.frame == CloudFrame::camera ? CloudFrame::world : CloudFrame::camera;
  const LengthUnit other_unit =
      given.unit == LengthUnit::metres ? LengthUnit::millimetres : LengthUnit::metres;
  const std::string set_frame =
      fmt::format("set observation.cloud_frame: {}", other_frame == CloudFrame::world ? "world" : "camera");
  const std::string set_unit =
      fmt::format("set observation.cloud_unit: {}", other_unit == LengthUnit::metres ? "m" : "mm");
  const bool may_be_other_frame = other_frame == CloudFrame::camera || has_pose;

  if (may_be_other_frame) add(camera_from_file(cloud, {other_frame, given.unit}, camera), set_frame);
  if (given.frame == CloudFrame::world)
    add(camera.world_from_camera * metres(given.unit),
        "camera.world_from_camera looks like its inverse; invert it");
  else if (!cloud.file_from_sensor.isApprox(Eigen::Isometry3d::Identity(), 0.0))
    add(Eigen::Affine3d(metres(given.unit)),
        "its points are in the sensor's frame already; set its VIEWPOINT to 0 0 0 1 0 0 0");
  for (const Axes& axes : other_axes())
    add(Eigen::Affine3d(axes.optical_from_axes) * as_given,
        fmt::format("its axes look like {}; turn them to x right, y down, z forward", axes.meaning));
  add(camera_from_file(cloud, {given.frame, other_unit}, camera), set_unit);
  if (may_be_other_frame)
    add(camera_from_file(cloud, {other_frame, other_unit}, camera),
        fmt::format("{} and {}", set_frame, set_unit));
  return out;
}

/// Judges how the points of a cloud can be taken; costs no more for large clouds.
class CloudJudge {
 public:
  CloudJudge(const PointCloud& cloud, const Intrinsics& intrinsics)
      : cloud_(cloud), intrinsics_(intrinsics), every_(cloud.points.size() / 20000 + 1) {}

  bool on_pixels(const Eigen::Affine3d& camera_from_file) const {
    return median_pixel_error(cloud_.points, camera_from_file, intrinsics_, every_) < largest_pixel_error;
  }
  bool in_view(const Eigen::Affine3d& camera_from_file) const {
    const CloudProjection seen = project_cloud(cloud_.points, camera_from_file, intrinsics_, every_);
    return static_cast<double>(seen.in_view) >= 0.9 * static_cast<double>(seen.readings);
  }

 private:
  const PointCloud& cloud_;
  const Intrinsics& intrinsics_;
  std::size_t every_;
};

/// The remedy of the first that fits, or `otherwise`.
template <typename Fits>
std::string remedy(const std::vector<Interpretation>& others, const Fits& fits,
                   const std::string& otherwise) {
  const auto found = std::find_if(others.begin(), others.end(),
                                  [&](const Interpretation& other) { return fits(other.camera_from_file); });
  return found != others.end() ? found->remedy : otherwise;
}

double median_depth(const DepthImage& depth) {
  std::vector<float> readings;
  std::copy_if(depth.data().begin(), depth.data().end(), std::back_inserter(readings),
               [](float z) { return z > 0.0F; });
  if (readings.empty()) return 0.0;
  const auto middle = readings.begin() + static_cast<std::ptrdiff_t>(readings.size() / 2);
  std::nth_element(readings.begin(), middle, readings.end());
  return static_cast<double>(*middle);
}

/// Which intrinsics an organized cloud was made with, or nothing where none make it.
std::string fitting_intrinsics(const PointCloud& cloud, const Intrinsics& given) {
  const Intrinsics fit = fitted_intrinsics(cloud.points, given);
  if (!(median_pixel_error(cloud.points, Eigen::Affine3d::Identity(), fit) < 0.5 * largest_pixel_error) ||
      !(fit.fx > 0.0 && fit.fy > 0.0))
    return {};
  return fmt::format("they fit fx {:.2f}, fy {:.2f}, cx {:.2f}, cy {:.2f}; give these in camera.intrinsics",
                     fit.fx, fit.fy, fit.cx, fit.cy);
}

DepthImage depth_of(const PointCloud& cloud, const CloudReading& reading, const Camera& camera,
                    bool has_pose) {
  const Intrinsics& k = camera.intrinsics;
  const Eigen::Affine3d as_given = camera_from_file(cloud, reading, camera);
  const CloudJudge judge(cloud, k);
  const auto fail = [](const std::string& what) { throw InputError(what); };
  const auto others = [&] { return other_interpretations(cloud, reading, camera, has_pose); };

  const auto width = static_cast<std::uint64_t>(k.width), height = static_cast<std::uint64_t>(k.height);
  const bool own_grid = cloud.grid && cloud.grid->width == width && cloud.grid->height == height;
  if (own_grid || (!cloud.grid && cloud.points.size() == width * height && judge.on_pixels(as_given))) {
    const double error = median_pixel_error(cloud.points, as_given, k);
    if (!(error < largest_pixel_error)) {
      std::string advice = fitting_intrinsics(cloud, k);
      if (advice.empty()) advice = "check camera.intrinsics and observation.cloud_frame";
      advice = remedy(
          others(), [&](const Eigen::Affine3d& t) { return judge.on_pixels(t); }, advice);
      fail(fmt::format("its points don't lie on their own pixels ({}); {}",
                       std::isfinite(error) ? fmt::format("median {:.3g} pixels off", error)
                                            : "most are not in front of the camera",
                       advice));
    }
    return depth_of_organized(cloud.points, as_given, k);
  }
  CloudProjection seen = project_cloud(cloud.points, as_given, k);
  if (static_cast<double>(seen.in_view) < smallest_share_in_view * static_cast<double>(seen.readings))
    fail(fmt::format("only {} of its {} points lie in front of the camera and inside the image; {}",
                     seen.in_view, seen.readings,
                     remedy(
                         others(), [&](const Eigen::Affine3d& t) { return judge.in_view(t); },
                         "check camera.intrinsics, observation.cloud_frame and the camera's pose, or cut "
                         "off what the camera doesn't see")));
  return std::move(seen.depth);
}

}  // namespace

DepthImage read_cloud_depth(const std::filesystem::path& path, const CloudReading& reading,
                            const Camera& camera, bool has_pose) {
  const PointCloud cloud = read_cloud(path);
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("{}: {}", shown(path), what));
  };
  if (std::none_of(cloud.points.begin(), cloud.points.end(),
                   [](const Eigen::Vector3d& p) { return p.allFinite() && !p.isZero(0.0); }))
    fail(fmt::format("none of its {} points is a reading; record it again", cloud.points.size()));
  DepthImage depth;
  try {
    depth = depth_of(cloud, reading, camera, has_pose);
  } catch (const InputError& e) {
    fail(e.what());
  }
  const double median = median_depth(depth);
  if (median > farthest_depth)
    fail(fmt::format("its median depth is {:.4g} m, beyond {} m; {}", median, farthest_depth,
                     reading.unit == LengthUnit::metres ? "millimetres taken for metres? set "
                                                          "observation.cloud_unit: mm"
                                                        : "check its lengths"));
  if (median < nearest_depth)
    fail(fmt::format("its median depth is {:.3g} m, nearer than {} m; {}", median, nearest_depth,
                     reading.unit == LengthUnit::millimetres ? "metres taken for millimetres? set "
                                                               "observation.cloud_unit: m"
                                                             : "check its lengths"));
  return depth;
}

}  // namespace perch
