#pragma once

#include <string>
#include <vector>

namespace perch {

/// One thing that a result states, and whether it holds.
struct Check {
  std::string name;        ///< e.g. "objects[1].visible_pixels"
  std::string reported;    ///< what the result says
  std::string recomputed;  ///< what it should say; a range where rounding decides
  bool holds = false;
};

using Checks = std::vector<Check>;

}  // namespace perch
