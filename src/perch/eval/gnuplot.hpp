#pragma once

#include <string>
#include <string_view>

#include "perch/core/error.hpp"

namespace perch {

/// The program gnuplot can't be started.
class NoGnuplot : public InputError {
 public:
  NoGnuplot();
};

/// What gnuplot writes to its standard output for a script, which it reads without any settings of the user.
/// Throws NoGnuplot where the program is not installed, std::runtime_error with its message where it fails.
std::string run_gnuplot(const std::string& script);

/// The text in quotes, as a script can hold it: no character in it means anything to gnuplot. What would,
/// and what is no printable ASCII, becomes an underscore.
std::string quoted_for_gnuplot(std::string_view text);

}  // namespace perch
