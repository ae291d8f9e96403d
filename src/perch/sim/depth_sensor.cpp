#include "perch/sim/depth_sensor.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "perch/core/error.hpp"
#include "perch/core/random.hpp"
#include "perch/sim/dark_patches.hpp"

namespace perch {
namespace {

/// True where the two pixels' depths are neighbours on one surface.
bool connected(float a, float b, double gap) {
  return a > 0.0F && b > 0.0F && std::abs(a - b) <= gap;
}

/// Which pixels of one row the projector's light doesn't reach. Camera and projector are rectified, so light
/// that falls on a pixel's point came along the projector's own row, at column u - f b / z.
class ShadowRow {
 public:
  ShadowRow(const float* depth, int width, double focal_baseline, double gap)
      : depth_(depth), width_(width), focal_baseline_(focal_baseline), gap_(gap) {
    float nearest = std::numeric_limits<float>::infinity();
    for (int u = 0; u < width; ++u)
      if (depth[u] > 0.0F) nearest = std::min(nearest, depth[u]);
    greatest_disparity_ = std::abs(focal_baseline) / nearest;
  }

  bool shadowed(int u) const {
    const double z = depth_[u], own = column(u);
    // Only what is nearer can stand in the way, and that lies on the projector's side of the pixel.
    const int side = focal_baseline_ > 0.0 ? 1 : -1;
    const int reach = static_cast<int>(greatest_disparity_ - std::abs(focal_baseline_) / z) + 2;
    for (int i = 1; i <= reach; ++i) {
      const int other = u + side * i;
      if (other < 0 || other >= width_) break;
      if (depth_[other] > 0.0F &&
          (covers(other, other + side, own, z) || (other - side != u && covers(other, other - side, own, z))))
        return true;
    }
    return false;
  }

 private:
  double column(int u) const { return u - focal_baseline_ / depth_[u]; }

  /// True where the surface from pixel `a` half way to its neighbour `b` crosses the projector's column in
  /// front of z.
  bool covers(int a, int b, double at_column, double z) const {
    constexpr double same = 1e-4;  // metres; a surface doesn't shadow itself by rounding
    const double from = column(a);
    const bool joined = b >= 0 && b < width_ && connected(depth_[a], depth_[b], gap_);
    // At its border a surface ends half a pixel beyond the last one that shows it.
    const double to = joined ? 0.5 * (from + column(b)) : from + 0.5 * (b - a);
    const double to_depth = joined ? 0.5 * (static_cast<double>(depth_[a]) + depth_[b]) : depth_[a];
    if (at_column < std::min(from, to) || at_column > std::max(from, to)) return false;
    const double t = from == to ? 0.0 : (at_column - from) / (to - from);
    return depth_[a] + t * (to_depth - depth_[a]) < z - same;
  }

  const float* depth_;
  int width_;
  double focal_baseline_;
  double gap_;
  double greatest_disparity_ = 0.0;
};

/// The cosine of the angle between the line of sight and the surface's normal; 1 where the neighbours don't
/// tell.
double facing(const DepthImage& depth, const RaySlopes& rays, int u, int v, double gap) {
  const float z = depth(u, v);
  const auto point = [&](int pu, int pv) { return rays.point(pu, pv, depth(pu, pv)).cast<double>().eval(); };
  // Along each axis the flatter of the two ways, which stays on the surface at its border.
  const auto tangent = [&](int du, int dv, Eigen::Vector3d& out) {
    double least = std::numeric_limits<double>::infinity();
    for (const int sign : {1, -1}) {
      const int pu = u + sign * du, pv = v + sign * dv;
      if (!depth.contains(pu, pv) || !connected(z, depth(pu, pv), gap)) continue;
      const double step = std::abs(depth(pu, pv) - z);
      if (step >= least) continue;
      least = step;
      out = sign * (point(pu, pv) - point(u, v));
    }
    return least < std::numeric_limits<double>::infinity();
  };
  Eigen::Vector3d across, down;
  if (!tangent(1, 0, across) || !tangent(0, 1, down)) return 1.0;
  return std::abs(across.cross(down).normalized().dot(point(u, v).normalized()));
}

/// What a pixel reads that sees its own surface and, with a share of its area, the one beside it at the
/// farthest other depth: their mean, weighted by the light that comes back, which falls with the square of
/// the distance. The phase of two echoes added up tends to that where their depths differ by little of the
/// sensor's range.
float mixed_depth(const DepthImage& depth, int u, int v, double gap, double share) {
  const float own = depth(u, v);
  float other = own;
  for (const auto& [du, dv] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
    if (!depth.contains(u + du, v + dv)) continue;
    const float z = depth(u + du, v + dv);
    if (z > 0.0F && !connected(own, z, gap) && std::abs(z - own) > std::abs(other - own)) other = z;
  }
  const double own_light = (1.0 - share) / (double{own} * own), other_light = share / (double{other} * other);
  return static_cast<float>((own_light * own + other_light * other) / (own_light + other_light));
}

}  // namespace

DepthSensorSettings DepthSensorSettings::structured_light() {
  DepthSensorSettings settings;
  settings.baseline = 0.05;
  settings.focal_length = 424.0;  // 848 pixels across 90 degrees
  settings.disparity_noise = 0.08;
  settings.disparity_step = 1.0 / 32.0;
  settings.nearest = 0.2;
  settings.farthest = 10.0;
  return settings;
}

DepthSensorSettings DepthSensorSettings::time_of_flight() {
  DepthSensorSettings settings;
  settings.disparity_noise = 0.0;
  settings.disparity_step = 0.0;
  settings.projector_shadow = false;
  settings.edge_jitter = 0.0;
  settings.depth_noise = 0.0005;
  settings.amplitude_noise = 0.001;
  settings.flying_pixels = 0.5;
  settings.nearest = 0.25;
  return settings;
}

const std::vector<std::string>& sensor_names() {
  static const std::vector<std::string> names{"kinect", "clean", "structured-light", "time-of-flight"};
  return names;
}

DepthSensorSettings named_sensor(const std::string& name) {
  if (name == "kinect") return DepthSensorSettings::kinect();
  if (name == "clean") return DepthSensorSettings::clean();
  if (name == "structured-light") return DepthSensorSettings::structured_light();
  if (name == "time-of-flight") return DepthSensorSettings::time_of_flight();
  throw InvalidSetting(fmt::format("'{}' is no sensor; known are {}", name, fmt::join(sensor_names(), ", ")));
}

DepthSensorSettings DepthSensorSettings::clean() {
  DepthSensorSettings settings;
  settings.disparity_noise = 0.0;
  settings.disparity_step = 0.0;
  settings.projector_shadow = false;
  settings.edge_jitter = 0.0;
  settings.dropout_rate = 0.0;
  settings.grazing_start = settings.grazing_end = std::numbers::pi / 2;
  settings.nearest = 0.0;
  settings.farthest = std::numeric_limits<double>::infinity();
  return settings;
}

void DepthSensorSettings::check() const {
  const auto require = [](bool holds, const char* field, double value, const char* range) {
    if (!holds) throw InvalidSetting(fmt::format("sensor.{} is {}; it must be {}", field, value, range));
  };
  const auto at_least_zero = [&](const char* field, double value) {
    require(std::isfinite(value) && value >= 0.0, field, value, "finite and >= 0");
  };
  require(std::isfinite(baseline) && baseline != 0.0, "baseline", baseline, "finite and not 0 (metres)");
  if (focal_length)
    require(std::isfinite(*focal_length) && *focal_length > 0.0, "focal_length", *focal_length,
            "finite and > 0 (pixels)");
  at_least_zero("disparity_noise", disparity_noise);
  at_least_zero("disparity_step", disparity_step);
  require(std::isfinite(disparity_offset), "disparity_offset", disparity_offset, "finite");
  at_least_zero("edge_jitter", edge_jitter);
  require(dropout_rate >= 0.0 && dropout_rate <= 1.0, "dropout_rate", dropout_rate, "in [0, 1]");
  constexpr double degree = std::numbers::pi / 180.0;
  constexpr double upright = std::numbers::pi / 2 * (1.0 + 1e-12);  // degrees are rounded
  require(grazing_start >= 0.0 && grazing_start <= upright, "grazing_start_deg", grazing_start / degree,
          "in [0, 90] (degrees)");
  require(grazing_end >= grazing_start && grazing_end <= upright, "grazing_end_deg", grazing_end / degree,
          "in [sensor.grazing_start_deg, 90] (degrees)");
  at_least_zero("depth_noise", depth_noise);
  at_least_zero("amplitude_noise", amplitude_noise);
  require(flying_pixels >= 0.0 && flying_pixels <= 1.0, "flying_pixels", flying_pixels, "in [0, 1]");
  require(dark_patches >= 0.0 && dark_patches <= 1.0, "dark_patches", dark_patches, "in [0, 1]");
  require(std::isfinite(dark_patch_size) && dark_patch_size > 0.0, "dark_patch_size", dark_patch_size,
          "finite and > 0 (metres)");
  at_least_zero("surface_gap", surface_gap);
  at_least_zero("nearest", nearest);
  require(farthest > nearest, "farthest", farthest, "greater than sensor.nearest (metres)");
}

DepthImage sense_depth(const DepthImage& ideal, const Intrinsics& intrinsics,
                       const DepthSensorSettings& settings, std::uint64_t seed) {
  return sense(ideal, intrinsics, settings, seed, Image<std::uint16_t>(ideal.width(), ideal.height(), 1))
      .depth;
}

SensedDepth sense(const DepthImage& ideal, const Intrinsics& intrinsics, const DepthSensorSettings& s,
                  std::uint64_t seed, const Image<std::uint16_t>& may_be_dark) {
  intrinsics.check();
  s.check();
  if (ideal.width() != intrinsics.width || ideal.height() != intrinsics.height)
    throw InvalidSetting(fmt::format("the depth image has {} x {} pixels, its intrinsics {} x {}",
                                     ideal.width(), ideal.height(), intrinsics.width, intrinsics.height));

  DepthImage lit = ideal;  // what camera and projector both see
  if (s.projector_shadow)
    for (int v = 0; v < ideal.height(); ++v) {
      const ShadowRow row(ideal.row(v), ideal.width(), intrinsics.fx * s.baseline, s.surface_gap);
      for (int u = 0; u < ideal.width(); ++u)
        if (ideal(u, v) > 0.0F && row.shadowed(u)) lit(u, v) = 0.0F;
    }

  // Apart, so that it reshuffles none of the others.
  const Image<std::uint8_t> dark = dark_patches(ideal, intrinsics, may_be_dark, s.dark_patches,
                                                s.dark_patch_size, seed ^ 0x6461726b00000000ULL);
  const RaySlopes rays(intrinsics);
  const double focal_baseline = s.focal_length.value_or(intrinsics.fx) * std::abs(s.baseline);
  const bool through_disparity = s.disparity_noise > 0.0 || s.disparity_step > 0.0;
  const bool direct = s.depth_noise > 0.0 || s.amplitude_noise > 0.0 || s.flying_pixels > 0.0;
  const double no_grazing = std::numbers::pi / 2;
  Random random(seed);
  Random direct_random = Random(~seed);  // apart, so that it reshuffles none of the others
  SensedDepth sensed{DepthImage(ideal.width(), ideal.height()),
                     Image<std::uint32_t>(ideal.width(), ideal.height())};
  for (int v = 0; v < ideal.height(); ++v)
    for (int u = 0; u < ideal.width(); ++u) {
      const double aside = s.edge_jitter * random.normal(), below = s.edge_jitter * random.normal();
      const double noise = s.disparity_noise * random.normal();
      const double grazing_draw = random.uniform(), dropout_draw = random.uniform();
      double depth_draw = 0.0, flying_draw = 1.0, share_draw = 0.0;
      if (direct) {
        depth_draw = direct_random.normal();
        flying_draw = direct_random.uniform();
        share_draw = direct_random.uniform();
      }

      const int ju = u + static_cast<int>(std::lround(aside)), jv = v + static_cast<int>(std::lround(below));
      // Within a surface the disparity's noise already says all that was measured.
      const bool looks_aside =
          ideal.contains(ju, jv) && !connected(ideal(u, v), ideal(ju, jv), s.surface_gap);
      const int su = looks_aside ? ju : u, sv = looks_aside ? jv : v;
      float z = lit(su, sv);
      if (z <= 0.0F || dropout_draw < s.dropout_rate || dark(su, sv) != 0) continue;
      const bool asks_angle = s.grazing_start < no_grazing || s.amplitude_noise > 0.0;
      const double cosine = asks_angle ? std::min(1.0, facing(ideal, rays, su, sv, s.surface_gap)) : 1.0;
      if (s.grazing_start < no_grazing) {
        const double angle = std::acos(cosine);
        const double ramp = std::max(s.grazing_end - s.grazing_start, 1e-9);
        if (grazing_draw < (angle - s.grazing_start) / ramp) continue;
      }
      if (flying_draw < s.flying_pixels) z = mixed_depth(lit, su, sv, s.surface_gap, 0.5 * share_draw);
      if (through_disparity) {
        double disparity = focal_baseline / z + noise + s.disparity_offset;
        if (s.disparity_step > 0.0) disparity = s.disparity_step * std::round(disparity / s.disparity_step);
        disparity -= s.disparity_offset;
        if (disparity <= 0.0) continue;
        z = static_cast<float>(focal_baseline / disparity);
      }
      if (direct) {
        constexpr double least_cosine = 0.01;  // no reading is without end
        const double deviation = s.depth_noise + s.amplitude_noise * z * z / std::max(cosine, least_cosine);
        z += static_cast<float>(deviation * depth_draw);
        if (z <= 0.0F) continue;
      }
      if (z < s.nearest || z > s.farthest) continue;
      sensed.depth(u, v) = z;
      sensed.source(u, v) = static_cast<std::uint32_t>(ideal.index(su, sv));
    }
  return sensed;
}

}  // namespace perch
