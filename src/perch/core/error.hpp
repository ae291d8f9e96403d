#pragma once

#include <stdexcept>
#include <string>

namespace perch {

/// Input that can't be used: a file, a key, a value. The message is one line that names file, key, value and
/// remedy. The command line prints it and exits with status 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A setting out of its range; the message names the field and the value.
class InvalidSetting : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace perch
