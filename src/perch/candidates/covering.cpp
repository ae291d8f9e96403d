#include "perch/candidates/covering.hpp"

#include <algorithm>

namespace perch {
namespace {

/// Numbers what is used in order; `number[i]` used ones stand before i.
std::vector<std::uint32_t> numbered(const std::vector<char>& used, std::vector<std::uint32_t>& left) {
  std::vector<std::uint32_t> number(used.size() + 1, 0);
  for (std::size_t i = 0; i < used.size(); ++i) {
    number[i + 1] = number[i] + static_cast<std::uint32_t>(used[i]);
    if (used[i]) left.push_back(static_cast<std::uint32_t>(i));
  }
  return number;
}

void mark(const std::vector<Run>& runs, std::vector<char>& used) {
  for (const Run& run : runs) std::fill(used.begin() + run.first, used.begin() + run.last, 1);
}

void renumber(std::vector<Run>& runs, const std::vector<std::uint32_t>& number) {
  for (Run& run : runs) run = {number[run.first], number[run.last]};
  std::erase_if(runs, [](const Run& run) { return run.first == run.last; });
}

}  // namespace

CoveringNumbers compact(Covering& covering) {
  CoveringNumbers left;
  std::vector<char> points(covering.points, 0), pixels(covering.pixels, 0);
  for (const Covering::Option& option : covering.options) {
    mark(option.explained, points);
    mark(option.certain, pixels);
    mark(option.uncertain, pixels);
  }
  const auto point_number = numbered(points, left.points), pixel_number = numbered(pixels, left.pixels);
  for (Covering::Option& option : covering.options) {
    renumber(option.explained, point_number);
    renumber(option.certain, pixel_number);
    renumber(option.uncertain, pixel_number);
    renumber(option.relieved, pixel_number);
  }
  // A point that nothing left explains costs 1 for certain.
  covering.fixed += static_cast<std::int64_t>(covering.points - left.points.size());
  covering.points = left.points.size();
  covering.pixels = left.pixels.size();
  return left;
}

}  // namespace perch
