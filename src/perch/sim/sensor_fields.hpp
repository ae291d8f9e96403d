#pragma once

#include <functional>
#include <string>
#include <vector>

#include "perch/sim/depth_sensor.hpp"

namespace perch {

/// One field of DepthSensorSettings as text.
struct SensorField {
  std::string key;   ///< e.g. "sensor.disparity_noise"
  std::string help;  ///< what it is, with unit and range
  std::function<void(DepthSensorSettings&, const std::string&)>
      set;  ///< throws InvalidSetting where the text is no value
  std::function<std::string(const DepthSensorSettings&)> get;
};

/// Every field there is.
const std::vector<SensorField>& sensor_fields();

/// Sets one field from text. Throws InvalidSetting naming key, value and remedy, also for an unknown key.
void set_sensor_field(DepthSensorSettings& settings, const std::string& key, const std::string& value);

}  // namespace perch
