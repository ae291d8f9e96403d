#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "perch/verify/count_range.hpp"
#include "perch/verify/sightings.hpp"

namespace perch {

/// A range of depths at which an object may be the nearest of the scene.
struct Seen {
  std::uint32_t object = 0;
  DepthRange depth;
};

/// What may be seen at one pixel of a scene.
struct SeenPixel {
  std::uint32_t pixel = 0;      ///< row-major
  bool may_miss = false;        ///< perhaps nothing is
  std::size_t first = 0, last;  ///< into SceneView's ranges: by ascending object, at least one
};

/// The nearest surfaces of several objects together, as far as rounding lets anyone say.
class SceneView {
 public:
  /// \param all the sightings of every object of the scene. \param objects how many there are.
  SceneView(std::vector<Sighting> all, std::size_t objects);

  const std::vector<SeenPixel>& pixels() const { return pixels_; }
  std::span<const Seen> seen(const SeenPixel& pixel) const {
    return {seen_.data() + pixel.first, pixel.last - pixel.first};
  }
  /// True where no other object than this one can be what is seen, and something is.
  bool is_certain(const SeenPixel& pixel, std::uint32_t object) const {
    return !pixel.may_miss && seen_[pixel.first].object == object && seen_[pixel.last - 1].object == object;
  }

  /// Pixels at which each object is seen.
  const std::vector<CountRange>& visible() const { return visible_; }
  /// Pixels that each object would cover alone.
  const std::vector<CountRange>& alone() const { return alone_; }

 private:
  void add_pixel(std::span<const Sighting> sightings);

  std::vector<SeenPixel> pixels_;
  std::vector<Seen> seen_;
  std::vector<CountRange> visible_, alone_;
};

}  // namespace perch
