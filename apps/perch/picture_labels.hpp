#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "picture_canvas.hpp"

namespace perch::app {

/// A name that wants to stand at a place of a picture.
struct Label {
  double x = 0.0, y = 0.0;           ///< where its middle should be, pixels
  double width = 0.0, height = 0.0;  ///< pixels
  std::int64_t importance = 0;       ///< the more important chooses first
};

/// Where each label stands: as near to its place as it can without meeting another, inside `area`. Empty
/// where there is no room near its place.
std::vector<std::optional<Box>> place_labels(const std::vector<Label>& labels, const Box& area);

}  // namespace perch::app
