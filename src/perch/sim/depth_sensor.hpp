#pragma once

#include <cstdint>
#include <optional>

#include "perch/core/camera.hpp"
#include "perch/core/image.hpp"

namespace perch {

/// What a structured-light depth camera of the first Kinect's kind does to a depth image. It measures the
/// disparity d = f b / z between its camera and a projector beside it. The defaults are the published
/// figures:
///   [K] Khoshelham and Elberink, "Accuracy and Resolution of Kinect Depth Data", Sensors 12, 2012;
///   [N] Nguyen, Izadi and Lovell, "Modeling Kinect Sensor Noise", 3DIMPVT 2012;
///   [H] Handa, Whelan, McDonald and Davison, "A Benchmark for RGB-D Visual Odometry", ICRA 2014.
struct DepthSensorSettings {
  /// Where the projector stands along the camera's x axis, metres; negative to the left. 7.5 cm [K].
  double baseline = 0.075;
  /// Focal length in which disparities are counted, pixels; the image's fx if absent. State it where the
  /// image is a thinned one, whose pixels are larger than the sensor's.
  std::optional<double> focal_length;
  /// Standard deviation of a disparity, pixels, 0 = none: half a step [K]; a sixth of one [H]. In depth it is
  /// z^2 / (f b) times as much.
  double disparity_noise = 0.0625;
  /// Disparities are multiples of this, pixels, 0 = not quantized; an eighth [K].
  double disparity_step = 0.125;
  /// Added to a disparity before it is rounded, pixels: shifts which depths can be read, not their mean.
  double disparity_offset = 0.0;
  /// Leaves out what the projector's light doesn't reach because something stands in its way.
  bool projector_shadow = true;
  /// Standard deviation of where a pixel looks, pixels along either axis, 0 = none; felt where the depth
  /// jumps. 0.8 [N].
  double edge_jitter = 0.8;
  /// The share of readings lost at random, in [0, 1]; our choice.
  double dropout_rate = 0.005;
  /// Angle between the line of sight and the surface's normal from which readings get lost, and the one from
  /// which all are, radians; the share grows linearly between them. [N] got readings up to about 70 degrees
  /// and few beyond 80. Off where both are pi / 2.
  double grazing_start = 1.2217;
  double grazing_end = 1.4486;
  /// Neighbouring pixels whose depths differ by more don't belong to one surface, metres; our choice.
  double surface_gap = 0.02;
  /// Readings outside this range are lost, metres. 0.5 to 5 m [K]; tables are often nearer.
  double nearest = 0.4;
  double farthest = 5.0;

  /// A sensor that changes nothing.
  static DepthSensorSettings clean();
  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

/// What the sensor reads where it should see `ideal` (metres along the optical axis, 0 = nothing there). The
/// same seed gives the same image; each pixel takes the same number of random numbers whatever the settings.
/// Throws InvalidSetting.
DepthImage sense_depth(const DepthImage& ideal, const Intrinsics& intrinsics,
                       const DepthSensorSettings& settings, std::uint64_t seed);

}  // namespace perch
