#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "perch/core/camera.hpp"
#include "perch/core/image.hpp"

namespace perch {

/// What a depth camera does to a depth image. One that triangulates measures the disparity d = f b / z
/// between its camera and a projector (or a second camera) beside it; one that times the light measures the
/// depth itself. The defaults are the published figures of the first Kinect:
///   [K] Khoshelham and Elberink, "Accuracy and Resolution of Kinect Depth Data", Sensors 12, 2012;
///   [N] Nguyen, Izadi and Lovell, "Modeling Kinect Sensor Noise", 3DIMPVT 2012;
///   [H] Handa, Whelan, McDonald and Davison, "A Benchmark for RGB-D Visual Odometry", ICRA 2014;
///   [M] Mallick, Das and Majumdar, "Characterizations of Noise in Kinect Depth Images", IEEE Sensors J. 14,
///       2014.
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
  /// The share of readings lost at random, in [0, 1]. [M] sees single pixels without depth come and go; how
  /// many is our choice.
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

  /// Standard deviation of a depth at any distance, metres, 0 = none.
  double depth_noise = 0.0;
  /// What is added to it, metres at 1 m where the surface is seen head on, 0 = none: grows with z^2 /
  /// cos(angle), as the light that comes back gets less. See time_of_flight().
  double amplitude_noise = 0.0;
  /// The share of pixels at jumps of depth that see both surfaces, in [0, 1]: they read a mean of the two,
  /// weighted by the light that comes back from each.
  double flying_pixels = 0.0;

  /// The share of what is seen of surfaces that is too dark or too shiny to be read, in [0, 1], in patches of
  /// about this size, metres: see sim/dark_patches.hpp. Ours.
  double dark_patches = 0.0;
  double dark_patch_size = 0.05;

  /// The first Kinect: the defaults.
  static DepthSensorSettings kinect() { return {}; }
  /// A sensor that changes nothing.
  static DepthSensorSettings clean();
  /// Active stereo with a short baseline, after Intel's D435: 50 mm, steps of 1/32 pixel, 848 pixels across
  /// 90 degrees (Grunnet-Jepsen, Sweetser, Khuong, Tong and Woodfill, "Subpixel Linearity Improvement for
  /// Intel RealSense Depth Camera D400 Series"), noise of 0.05 to 0.1 pixels on surfaces with texture
  /// (Grunnet-Jepsen, Sweetser and Woodfill, "Tuning depth cameras for best performance"). Where the second
  /// camera doesn't see, as where a projector doesn't shine, there is no reading. The other figures are the
  /// Kinect's.
  static DepthSensorSettings structured_light();
  /// Time of flight: noise inverse to the amplitude of the light (Lange and Seitz, "Solid-State
  /// Time-of-Flight Range Camera", IEEE J. Quantum Electronics 37, 2001), flying pixels (Sarbolandi, Lefloch
  /// and Kolb, "Kinect Range Sensing: Structured-Light versus Time-of-Flight Kinect", CVIU 139, 2015). The
  /// figures keep within the 17 mm to 3.5 m that are stated and confirmed for the Azure Kinect (Toelgyessy,
  /// Dekan, Chovanec and Hubinsky, Sensors 21, 2021): 0.5 mm + 1 mm z^2. Left out: light that comes back on
  /// several paths, and errors that repeat with the distance.
  static DepthSensorSettings time_of_flight();
  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

/// "kinect", "clean", "structured-light", "time-of-flight".
const std::vector<std::string>& sensor_names();
/// The settings of that name. Throws InvalidSetting for a name not in sensor_names().
DepthSensorSettings named_sensor(const std::string& name);

/// What the sensor reads where it should see `ideal` (metres along the optical axis, 0 = nothing there). The
/// same seed gives the same image; each pixel takes the same number of random numbers whatever the settings.
/// Throws InvalidSetting.
DepthImage sense_depth(const DepthImage& ideal, const Intrinsics& intrinsics,
                       const DepthSensorSettings& settings, std::uint64_t seed);

/// Readings, and where they were made.
struct SensedDepth {
  DepthImage depth;
  /// For each reading the index of the pixel of the ideal image whose surface it measures: its own or, where
  /// the depth jumps, one nearby. No meaning where there is no reading.
  Image<std::uint32_t> source;
};

/// As sense_depth. \param may_be_dark not 0 where dark patches may be.
SensedDepth sense(const DepthImage& ideal, const Intrinsics& intrinsics, const DepthSensorSettings& settings,
                  std::uint64_t seed, const Image<std::uint16_t>& may_be_dark);

}  // namespace perch
