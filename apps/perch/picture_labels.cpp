#include "picture_labels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace perch::app {
namespace {

constexpr double between = 2.0;  // pixels between labels

bool meet(const Box& a, const Box& b) {
  return a.x < b.right() + between && b.x < a.right() + between && a.y < b.bottom() + between &&
         b.y < a.bottom() + between;
}

/// The first free place on rings of growing radius around where the label wants to be.
std::optional<Box> free_place(const Label& label, const Box& area, const std::vector<Box>& taken) {
  if (label.width > area.width || label.height > area.height) return std::nullopt;
  constexpr int rings = 16, directions = 16;
  for (int ring = 0; ring <= rings; ++ring)
    for (int k = 0; k < (ring == 0 ? 1 : directions); ++k) {
      // Straight up and down first: text is wide and low.
      const double angle =
          (k % 2 ? -1 : 1) * std::numbers::pi * ((k + 1) / 2) / (directions / 2.0) - std::numbers::pi / 2.0;
      const double radius = ring * 0.5 * label.height;
      const double x = label.x + 1.5 * radius * std::cos(angle), y = label.y + radius * std::sin(angle);
      const Box box{std::clamp(x - label.width / 2, area.x, area.right() - label.width),
                    std::clamp(y - label.height / 2, area.y, area.bottom() - label.height), label.width,
                    label.height};
      if (std::none_of(taken.begin(), taken.end(), [&](const Box& other) { return meet(box, other); }))
        return box;
    }
  return std::nullopt;
}

}  // namespace

std::vector<std::optional<Box>> place_labels(const std::vector<Label>& labels, const Box& area) {
  std::vector<std::size_t> order(labels.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return labels[a].importance > labels[b].importance; });
  std::vector<std::optional<Box>> places(labels.size());
  std::vector<Box> taken;
  for (const std::size_t i : order) {
    places[i] = free_place(labels[i], area, taken);
    if (places[i]) taken.push_back(*places[i]);
  }
  return places;
}

}  // namespace perch::app
