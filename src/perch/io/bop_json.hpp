#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>

#include "perch/io/json_entry.hpp"

namespace perch {

/// A JSON file of a BOP data set; for use inside io. Throws InputError.
JsonEntry read_bop_json(const std::filesystem::path& file);

/// A whole number from 0 to 999,999, of which BOP makes six digits.
int bop_number(const JsonEntry& entry);

/// "000017".
std::string six_digits(int number);

/// A rotation of 9 numbers, row after row. Throws InputError where it is none to 1e-3.
Eigen::Matrix3d bop_rotation(const JsonEntry& entry);

/// Three lengths in millimetres, as metres.
Eigen::Vector3d bop_lengths(const JsonEntry& entry);

}  // namespace perch
