#include "perch/sim/sensor_fields.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <numbers>

#include "perch/core/error.hpp"

namespace perch {
namespace {

double number_field(const std::string& key, const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || std::isnan(value))
    throw InvalidSetting(fmt::format("{}: '{}' is not a number", key, text));
  return value;
}

SensorField number(const std::string& key, std::string help, double DepthSensorSettings::*member,
                   double unit = 1.0) {
  return {
      key, std::move(help),
      [=](DepthSensorSettings& s, const std::string& text) { s.*member = unit * number_field(key, text); },
      [=](const DepthSensorSettings& s) { return fmt::format("{:.6g}", s.*member / unit); }};
}

SensorField optional_number(const std::string& key, std::string help,
                            std::optional<double> DepthSensorSettings::*member) {
  return {
      key, std::move(help),
      [=](DepthSensorSettings& s, const std::string& text) {
        s.*member = text == "auto" ? std::nullopt : std::optional(number_field(key, text));
      },
      [=](const DepthSensorSettings& s) { return s.*member ? fmt::format("{:.6g}", *(s.*member)) : "auto"; }};
}

SensorField truth_value(const std::string& key, std::string help, bool DepthSensorSettings::*member) {
  return {key, std::move(help),
          [=](DepthSensorSettings& s, const std::string& text) {
            if (text != "true" && text != "false")
              throw InvalidSetting(fmt::format("{}: '{}' is not true or false", key, text));
            s.*member = text == "true";
          },
          [=](const DepthSensorSettings& s) { return std::string(s.*member ? "true" : "false"); }};
}

std::vector<SensorField> make_sensor_fields() {
  using S = DepthSensorSettings;
  constexpr double degree = std::numbers::pi / 180.0;
  return {
      number("sensor.baseline", "camera to projector along x, metres; negative: to the left", &S::baseline),
      optional_number("sensor.focal_length",
                      "in which disparities are counted, pixels; auto: that of a 640-pixel image, 525",
                      &S::focal_length),
      number("sensor.disparity_noise", "standard deviation, pixels", &S::disparity_noise),
      number("sensor.disparity_step", "disparities are multiples of it, pixels; 0: not quantized",
             &S::disparity_step),
      number("sensor.disparity_offset", "added before rounding, pixels", &S::disparity_offset),
      truth_value("sensor.projector_shadow", "no reading where the projector doesn't reach: true or false",
                  &S::projector_shadow),
      number("sensor.edge_jitter", "where a pixel looks at jumps of depth, standard deviation, pixels",
             &S::edge_jitter),
      number("sensor.dropout_rate", "share of readings lost at random, 0 to 1", &S::dropout_rate),
      number("sensor.grazing_start_deg",
             "angle to the surface's normal from which readings get lost, degrees", &S::grazing_start,
             degree),
      number("sensor.grazing_end_deg", "and from which all are, degrees", &S::grazing_end, degree),
      number("sensor.surface_gap", "neighbours farther apart in depth are not of one surface, metres",
             &S::surface_gap),
      number("sensor.nearest", "readings nearer are lost, metres", &S::nearest),
      number("sensor.farthest", "readings farther are lost, metres; inf: none", &S::farthest),
      number("sensor.depth_noise", "standard deviation of a depth, metres", &S::depth_noise),
      number("sensor.amplitude_noise",
             "and what is added to it at 1 m head on, growing with z^2 / cos(angle), metres",
             &S::amplitude_noise),
      number("sensor.flying_pixels", "share of pixels at jumps of depth that mix the two, 0 to 1",
             &S::flying_pixels),
      number("sensor.dark_patches", "share of the objects' surface that can't be read, in patches, 0 to 1",
             &S::dark_patches),
      number("sensor.dark_patch_size", "their size, metres", &S::dark_patch_size),
  };
}

}  // namespace

const std::vector<SensorField>& sensor_fields() {
  static const std::vector<SensorField> fields = make_sensor_fields();
  return fields;
}

void set_sensor_field(DepthSensorSettings& settings, const std::string& key, const std::string& value) {
  std::vector<std::string> known;
  for (const SensorField& field : sensor_fields()) {
    if (field.key == key) return field.set(settings, value);
    known.push_back(field.key);
  }
  throw InvalidSetting(fmt::format("{}: unknown setting; known are {}", key, fmt::join(known, ", ")));
}

}  // namespace perch
