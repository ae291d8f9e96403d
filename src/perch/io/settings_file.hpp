#pragma once

#include <filesystem>

#include "perch/localize/settings.hpp"

namespace perch {

/// Sets the fields that a YAML file names, either nested (`cost: {delta: 0.003}`) or with dots (`cost.delta:
/// 0.003`). Throws InputError, one line that names the file, the key and the value.
void read_settings(const std::filesystem::path& path, Settings& settings);

}  // namespace perch
