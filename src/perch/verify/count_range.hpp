#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>

namespace perch {

/// The values that a count may have where rounding decides.
struct CountRange {
  std::int64_t low = 0, high = 0;

  bool contains(std::int64_t count) const { return low <= count && count <= high; }
  std::int64_t width() const { return high - low; }
  /// Takes in one thing that is counted or not: for certain, perhaps, or not at all.
  void add(bool certain, bool possible) {
    low += certain;
    high += certain || possible;
  }
  std::string text() const {
    return low == high ? fmt::format("{}", low) : fmt::format("{} to {} (width {})", low, high, width());
  }

  friend CountRange operator+(const CountRange& a, const CountRange& b) {
    return {a.low + b.low, a.high + b.high};
  }
  friend bool operator==(const CountRange&, const CountRange&) = default;
};

}  // namespace perch
