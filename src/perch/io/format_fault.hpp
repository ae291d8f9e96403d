#pragma once

#include <string>

namespace perch {

/// Thrown by the readers of a file format, caught where the file's name is known: a clause that says what is
/// wrong ("is truncated").
struct FormatFault {
  std::string what;
};

}  // namespace perch
