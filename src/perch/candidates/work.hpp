#pragma once

#include <cstdint>

#include "perch/core/image.hpp"

namespace perch {

/// What was done to answer, counted rather than timed: the same for every executor and instruction set. The
/// views of models that ICP samples are left out: each is rendered once, by whoever needs it first.
struct Work {
  std::int64_t renderings = 0;  ///< of a whole model
  std::int64_t alignments = 0;  ///< rounds of ICP
  std::int64_t pixels = 0;      ///< in the windows of the renderings

  void add_rendering(const Window& window) {
    ++renderings;
    pixels += std::int64_t{window.width()} * window.height();
  }
  Work& operator+=(const Work& other) {
    renderings += other.renderings;
    alignments += other.alignments;
    pixels += other.pixels;
    return *this;
  }
  friend bool operator==(const Work&, const Work&) = default;
};

}  // namespace perch
