#include "perch/sim/catalogue_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace perch {
namespace {

using std::numbers::pi;

Mesh turned_about(Mesh mesh, double angle) {
  return moved(std::move(mesh), Eigen::Isometry3d(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())));
}

/// A round tube through the points, from inside one part to wherever it ends.
Mesh spout_mesh(const std::vector<Eigen::Vector2d>& path_xz, double radius) {
  return tube(path_xz, radius, radius, 20);
}

/// A rectangle about the z axis at a height, counter-clockwise from above; `per_side` points on each side.
std::vector<Eigen::Vector3d> rectangle(double half_x, double half_y, double z, int per_side) {
  const std::vector<Eigen::Vector2d> corners{
      {half_x, -half_y}, {half_x, half_y}, {-half_x, half_y}, {-half_x, -half_y}};
  std::vector<Eigen::Vector3d> ring;
  for (std::size_t c = 0; c < 4; ++c)
    for (int k = 0; k < per_side; ++k) {
      const Eigen::Vector2d p = corners[c] + (corners[(c + 1) % 4] - corners[c]) * k / per_side;
      ring.emplace_back(p.x(), p.y(), z);
    }
  return ring;
}

}  // namespace

Mesh even_can_mesh(double radius, double height) {
  constexpr double sunk = 0.003, lip = 0.001, rim = 0.002;
  return turned(Profile{{0.0, sunk},
                        {radius - sunk, sunk},
                        {radius - sunk, 0.0},
                        {radius - lip, 0.0},
                        {radius, rim},
                        {radius, height - rim},
                        {radius - lip, height},
                        {radius - sunk, height},
                        {radius - sunk, height - sunk},
                        {0.0, height - sunk}});
}

Mesh plate_mesh(double radius, double middle_radius, double height) {
  constexpr double thickness = 0.004;
  return turned(Profile{{0.0, 0.0},
                        {middle_radius, 0.0},
                        {radius, height - thickness},
                        {radius, height},
                        {middle_radius - 0.5 * thickness, thickness},
                        {0.0, thickness}});
}

Mesh goblet_mesh() {
  return turned(Profile{{0.0, 0.0},
                        {0.034, 0.0},
                        {0.034, 0.003},
                        {0.007, 0.008},
                        {0.0045, 0.02},
                        {0.0045, 0.07},
                        {0.02, 0.081},
                        {0.036, 0.105},
                        {0.039, 0.125},
                        {0.034, 0.17},
                        {0.032, 0.17},
                        {0.037, 0.125},
                        {0.034, 0.106},
                        {0.018, 0.084},
                        {0.0, 0.08}});
}

Mesh vase_mesh() {
  const Profile corners{{0.0, 0.0},    {0.035, 0.0},  {0.055, 0.06}, {0.022, 0.16}, {0.038, 0.22},
                        {0.035, 0.22}, {0.019, 0.16}, {0.05, 0.062}, {0.03, 0.008}, {0.0, 0.008}};
  return turned(rounded(corners, 0.004));
}

Mesh mill_mesh() {
  const Profile corners{{0.0, 0.0},    {0.028, 0.0},   {0.028, 0.03},  {0.018, 0.075}, {0.024, 0.125},
                        {0.02, 0.133}, {0.026, 0.155}, {0.012, 0.178}, {0.012, 0.192}, {0.0, 0.192}};
  return turned(rounded(corners, 0.005));
}

Mesh gabled_carton_mesh(double width, double depth, double height) {
  constexpr int per_side = 10;
  const double eaves = height - 0.055, ridge = height - 0.018, fin = 0.003;
  const double half_x = 0.5 * width, half_y = 0.5 * depth;
  std::vector<std::vector<Eigen::Vector3d>> rings{{Eigen::Vector3d::Zero()}};
  const int levels = std::max(1, static_cast<int>(std::ceil(eaves / 0.015)));
  for (int i = 0; i <= levels; ++i) rings.push_back(rectangle(half_x, half_y, eaves * i / levels, per_side));
  rings.push_back(rectangle(half_x, fin, ridge, per_side));
  rings.push_back(rectangle(half_x, fin, height, per_side));
  rings.push_back({Eigen::Vector3d(0.0, 0.0, height)});
  return loft(rings);
}

Mesh flat_bottle_mesh(const FlatBottleShape& s) {
  const double shoulder = s.height - s.cap_height;
  const Profile corners{{0.0, 0.0},
                        {0.9 * s.half_width, 0.0},
                        {s.half_width, 0.04},
                        {s.half_width, 0.8 * shoulder},
                        {s.cap_radius + 0.002, shoulder},
                        {0.0, shoulder}};
  return merged(
      {scaled(turned(rounded(corners, 0.012)), {1.0, s.half_depth / s.half_width, 1.0}),
       moved(frustum(s.cap_radius, s.tip_radius, s.cap_height + 0.004), shift(0, 0, shoulder - 0.004))});
}

Mesh dish_mesh(double half_width, double half_depth, double height) {
  // A superellipse of exponent 5: nearly straight sides, round corners.
  const Section rounded_square = [](double angle, double) {
    return std::pow(std::pow(std::abs(std::cos(angle)), 5) + std::pow(std::abs(std::sin(angle)), 5), -0.2);
  };
  const Profile profile = vessel(0.9 * half_width, half_width, height, 0.007, 0.007);
  return scaled(turned(profile, rounded_square), {1.0, half_depth / half_width, 1.0});
}

Mesh soup_cup_mesh() {
  constexpr double bottom = 0.038, rim = 0.056, height = 0.062, wall = 0.0045;
  const HandleShape handle{.top = 0.052, .bottom = 0.024, .reach = 0.022};
  const auto middle = [&](double z) { return bottom + (rim - bottom) * z / height - wall / 2; };
  const Mesh one = handle_mesh(handle, middle(handle.top), middle(handle.bottom));
  return merged({turned(vessel(bottom, rim, height, wall, 0.007)), one, turned_about(one, pi)});
}

Mesh saucepan_mesh() {
  constexpr double radius = 0.075, height = 0.085, wall = 0.004;
  std::vector<Eigen::Vector2d> path;
  for (int i = 0; i <= 10; ++i)
    path.emplace_back(radius - wall / 2 + 0.014 * i, 0.066 + 0.014 * std::sin(0.5 * pi * i / 10));
  return merged({turned(vessel(radius, radius, height, wall, 0.006)), tube(path, 0.011, 0.006, 20)});
}

Mesh teapot_mesh() {
  const Profile corners{{0.0, 0.0},     {0.045, 0.0},  {0.075, 0.045}, {0.065, 0.09},  {0.036, 0.108},
                        {0.034, 0.114}, {0.008, 0.12}, {0.006, 0.126}, {0.011, 0.134}, {0.0, 0.14}};
  const HandleShape handle{
      .top = 0.095, .bottom = 0.035, .reach = 0.045, .half_width = 0.007, .half_thickness = 0.006};
  const std::vector<Eigen::Vector2d> spout{{-0.055, 0.035}, {-0.08, 0.043}, {-0.095, 0.06},
                                           {-0.104, 0.08},  {-0.118, 0.1},  {-0.125, 0.105}};
  return merged({turned(rounded(corners, 0.01)), handle_mesh(handle, 0.052, 0.06), spout_mesh(spout, 0.011)});
}

Mesh watering_can_mesh() {
  const Profile corners{{0.0, 0.0},    {0.065, 0.0},  {0.065, 0.09}, {0.05, 0.115},
                        {0.03, 0.115}, {0.03, 0.105}, {0.0, 0.105}};
  const HandleShape handle{
      .top = 0.105, .bottom = 0.03, .reach = 0.05, .half_width = 0.009, .half_thickness = 0.005};
  const std::vector<Eigen::Vector2d> spout{{-0.055, 0.025}, {-0.09, 0.065}, {-0.125, 0.11}, {-0.15, 0.145}};
  const Eigen::Isometry3d rose =
      Eigen::Translation3d(-0.145, 0.0, 0.138) * Eigen::AngleAxisd(-0.9, Eigen::Vector3d::UnitY());
  return merged({turned(corners), handle_mesh(handle, 0.05, 0.06), spout_mesh(spout, 0.009),
                 moved(frustum(0.009, 0.022, 0.022), rose)});
}

Mesh detergent_mesh() {
  constexpr double height = 0.27;
  const Profile corners{{0.0, 0.0}, {0.06, 0.0}, {0.062, 0.15}, {0.04, 0.2}, {0.02, 0.24}, {0.0, 0.24}};
  const HandleShape handle{
      .top = 0.222, .bottom = 0.11, .reach = 0.03, .half_width = 0.012, .half_thickness = 0.008};
  return merged({scaled(turned(rounded(corners, 0.015)), {1.0, 0.65, 1.0}), handle_mesh(handle, 0.018, 0.055),
                 moved(frustum(0.022, 0.02, height - 0.234), shift(0, 0, 0.234))});
}

}  // namespace perch
