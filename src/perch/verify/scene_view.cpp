#include "perch/verify/scene_view.hpp"

#include <algorithm>
#include <limits>

namespace perch {
namespace {

/// Calls `visit` with each run of elements that have the same key.
template <typename T, typename Key, typename Visit>
void for_each_run(std::span<const T> all, Key key, Visit visit) {
  for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
    while (last < all.size() && key(all[last]) == key(all[first])) ++last;
    visit(all.subspan(first, last - first));
  }
}

}  // namespace

SceneView::SceneView(std::vector<Sighting> all, std::size_t objects) : visible_(objects), alone_(objects) {
  std::stable_sort(all.begin(), all.end(), [](const Sighting& a, const Sighting& b) {
    return a.pixel != b.pixel ? a.pixel < b.pixel : a.object < b.object;
  });
  for_each_run(
      std::span<const Sighting>(all), [](const Sighting& s) { return s.pixel; },
      [&](std::span<const Sighting> sightings) { add_pixel(sightings); });
}

void SceneView::add_pixel(std::span<const Sighting> sightings) {
  // Nothing behind the farthest depth of an object that can't be missed is seen.
  double ceiling = std::numeric_limits<double>::infinity();
  SeenPixel pixel{sightings.front().pixel, true, seen_.size(), seen_.size()};
  const auto object_of = [](const auto& s) { return s.object; };
  for_each_run(sightings, object_of, [&](std::span<const Sighting> ranges) {
    const Sighting& any = ranges.front();
    alone_[any.object].add(!any.may_miss, true);
    if (any.may_miss) return;
    pixel.may_miss = false;
    double farthest = 0.0;
    for (const Sighting& s : ranges) farthest = std::max(farthest, s.depth.far);
    ceiling = std::min(ceiling, farthest);
  });
  for (const Sighting& s : sightings)
    if (s.depth.near <= ceiling) seen_.push_back({s.object, {s.depth.near, std::min(s.depth.far, ceiling)}});
  pixel.last = seen_.size();
  pixels_.push_back(pixel);
  for_each_run(seen(pixel), object_of, [&](std::span<const Seen> ranges) {
    visible_[ranges.front().object].add(is_certain(pixel, ranges.front().object), true);
  });
}

}  // namespace perch
