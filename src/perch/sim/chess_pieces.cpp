#include "perch/sim/chess_pieces.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>

#include "perch/core/error.hpp"
#include "perch/sim/shape_parts.hpp"

namespace perch {
namespace {

constexpr double millimetre = 0.001;
constexpr double ring_spacing = 0.004;

/// From millimetres.
Mesh turned_piece(Profile profile) {
  for (ProfilePoint& point : profile) {
    point.radius *= millimetre;
    point.z *= millimetre;
  }
  return turned(profile, {}, ring_spacing);
}

void append(Profile& profile, const Profile& more) {
  profile.insert(profile.end(), more.begin(), more.end());
}

/// The outline of an ellipsoid about the axis from one height to another, ends included: `radius` wide at
/// `middle`, `half_height` above and below it.
Profile ellipsoid(double radius, double middle, double half_height, double from, double to) {
  constexpr int chords = 10;
  const double first = std::asin((from - middle) / half_height),
               last = std::asin((to - middle) / half_height);
  Profile arc;
  for (int i = 0; i <= chords; ++i) {
    const double angle = first + (last - first) * i / chords;
    arc.push_back({radius * std::cos(angle), middle + half_height * std::sin(angle)});
  }
  return arc;
}

Mesh pawn() {
  Profile p{{0, 0},    {12.5, 0}, {12.5, 4}, {10.5, 7}, {10.5, 9},  {7.5, 13},
            {5.2, 22}, {4.8, 30}, {8, 31.5}, {8, 33},   {4.8, 34.5}};
  append(p, ellipsoid(8, 42, 8, 36, 49.5));
  p.push_back({0, 50});
  return turned_piece(p);
}

Mesh rook() {
  return turned_piece({{0, 0},
                       {13.75, 0},
                       {13.75, 5},
                       {11.5, 8},
                       {11.5, 10},
                       {9, 14},
                       {8, 36},
                       {8, 38},
                       {11, 41},
                       {11, 55},
                       {8, 55},
                       {8, 49},
                       {0, 49}});
}

Mesh bishop() {
  Profile p{{0, 0},    {16, 0},   {16, 5},   {13, 8.5}, {13, 11}, {9, 16},
            {6.2, 28}, {5.2, 42}, {9.5, 44}, {9.5, 46}, {5.5, 48}};
  append(p, ellipsoid(8.5, 56.5, 10, 50, 65.5));
  append(p, ellipsoid(2.7, 67.5, 2.5, 66.3, 69.8));
  p.push_back({0, 70});
  return turned_piece(p);
}

Mesh queen() {
  Profile p{{0, 0},     {18.5, 0},  {18.5, 6},   {15, 9.5}, {15, 12.5}, {10, 18},   {7, 34},  {6, 54},
            {11, 56.5}, {11, 58.5}, {6.5, 60.5}, {7.5, 65}, {12.5, 77}, {10.5, 78}, {5, 79.5}};
  append(p, ellipsoid(3, 82, 3, 80.2, 84.8));
  p.push_back({0, 85});
  return turned_piece(p);
}

Mesh king() {
  const Mesh body = turned_piece({{0, 0},
                                  {20, 0},
                                  {20, 6},
                                  {16, 10},
                                  {16, 13.5},
                                  {11, 20},
                                  {7.5, 38},
                                  {6.5, 60},
                                  {12, 62.5},
                                  {12, 65},
                                  {7, 67},
                                  {8, 70},
                                  {12.5, 80},
                                  {11, 82.5},
                                  {4, 85},
                                  {0, 85.5}});
  constexpr double cell = 0.003;
  const Mesh upright = moved(box({0.005, 0.005, 0.011}, cell), shift(0, 0, 0.084));
  const Mesh arms = moved(box({0.013, 0.005, 0.004}, cell), shift(0, 0, 0.0875));
  return merged({body, upright, arms});
}

/// A head of elliptic sections on a turned base: back and front along x and half the width along y at each
/// height, millimetres.
Mesh knight() {
  struct Level {
    double z, back, front, half_width;
  };
  static constexpr Level levels[] = {{10, -10, 9.5, 8.5}, {14, -9.5, 8.5, 7.5}, {22, -9.5, 6.5, 6},
                                     {30, -10, 6, 5.5},   {36, -10, 9, 5.5},    {39, -10, 15, 5.2},
                                     {44, -9.5, 16, 5.2}, {48, -9, 13, 5},      {52, -8, 7, 4.8},
                                     {56, -6, 2, 4},      {59, -4.5, -0.5, 2.5}};
  constexpr int points = 32;
  std::vector<std::vector<Eigen::Vector3d>> rings;
  const auto middle = [](const Level& level) { return 0.5 * (level.back + level.front); };
  rings.push_back({millimetre * Eigen::Vector3d(middle(levels[0]), 0, levels[0].z)});
  for (const Level& level : levels) {
    auto& ring = rings.emplace_back();
    for (int k = 0; k < points; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / points;
      ring.push_back(millimetre *
                     Eigen::Vector3d(middle(level) + 0.5 * (level.front - level.back) * std::cos(angle),
                                     level.half_width * std::sin(angle), level.z));
    }
  }
  rings.push_back({millimetre * Eigen::Vector3d(-3, 0, 60)});
  const Mesh base = turned_piece({{0, 0}, {15, 0}, {15, 5}, {12, 8}, {12, 11}, {9, 12}, {0, 12}});
  return merged({base, loft(rings)});
}

}  // namespace

const std::vector<std::string>& chess_model_names() {
  static const std::vector<std::string> names{"bishop", "king", "knight", "pawn", "queen", "rook"};
  return names;
}

SceneModel chess_model(std::string_view name) {
  const std::string piece(name);
  if (name == "bishop") return {piece, bishop(), Symmetry::continuous(), 0.0};
  if (name == "king") return {piece, king(), Symmetry::n_fold(2), 0.0};
  if (name == "knight") return {piece, knight(), Symmetry::none(), 0.0};
  if (name == "pawn") return {piece, pawn(), Symmetry::continuous(), 0.0};
  if (name == "queen") return {piece, queen(), Symmetry::continuous(), 0.0};
  if (name == "rook") return {piece, rook(), Symmetry::continuous(), 0.0};
  throw InputError(fmt::format("no chess piece is called '{}'; there are: {}", name,
                               fmt::join(chess_model_names(), ", ")));
}

}  // namespace perch
