#include "perch/sim/parametric_models.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "perch/core/error.hpp"
#include "perch/sim/shape_parts.hpp"

namespace perch {
namespace {

using std::numbers::pi;
constexpr double edge = 0.003;  // metres of rounding where solids of household things have any

}  // namespace

Profile can_profile(const CanShape& s) {
  constexpr double rim = 0.002, sunk = 0.003;
  return {{0.0, 0.0},
          {s.radius - rim, 0.0},
          {s.radius, rim},
          {s.radius, s.height},
          {s.radius - rim, s.height},
          {s.radius - rim, s.height - sunk},
          {0.0, s.height - sunk}};
}

Mesh can_mesh(const CanShape& s) {
  return turned(can_profile(s));
}

Profile bottle_profile(const BottleShape& s) {
  const double cap = 0.02, neck = s.height - cap - 0.02;
  const Profile corners{{0.0, 0.0},
                        {s.radius, 0.0},
                        {s.radius, s.shoulder},
                        {s.neck_radius, neck},
                        {s.neck_radius, s.height - cap},
                        {s.neck_radius + 0.003, s.height - cap},
                        {s.neck_radius + 0.003, s.height},
                        {0.0, s.height}};
  Profile smooth = rounded(std::span(corners).subspan(0, 5), 0.02, 6);
  smooth.insert(smooth.end(), corners.begin() + 5, corners.end());
  return smooth;
}

Mesh bottle_mesh(const BottleShape& s) {
  return turned(bottle_profile(s));
}

Profile jar_profile(const JarShape& s) {
  const double neck = s.height - s.lid_height, neck_radius = s.lid_radius - 0.004;
  const Profile corners{
      {0.0, 0.0}, {s.radius, 0.0}, {s.radius, neck - 0.02}, {neck_radius, neck - 0.004}, {neck_radius, neck}};
  Profile smooth = rounded(corners, 0.01);
  smooth.insert(smooth.end(), {{s.lid_radius, neck}, {s.lid_radius, s.height}, {0.0, s.height}});
  return smooth;
}

Mesh jar_mesh(const JarShape& s) {
  return turned(jar_profile(s));
}

Profile glass_profile(const GlassShape& s) {
  return vessel(s.bottom_radius, s.rim_radius, s.height, s.wall, s.bottom);
}

Mesh glass_mesh(const GlassShape& s) {
  return turned(glass_profile(s));
}

Profile bowl_profile(const BowlShape& s) {
  constexpr int chords = 12;
  Profile profile{{0.0, 0.0}};
  const auto arc = [&](int i, double foot, double rim, double bottom) {
    const double angle = 0.5 * pi * i / chords;
    profile.push_back(
        {foot + (rim - foot) * std::sin(angle), bottom + (s.height - bottom) * (1.0 - std::cos(angle))});
  };
  for (int i = 0; i <= chords; ++i) arc(i, s.foot_radius, s.radius, 0.0);
  for (int i = chords; i >= 0; --i) arc(i, s.foot_radius - s.wall, s.radius - s.wall, s.wall);
  profile.push_back({0.0, s.wall});
  return profile;
}

Mesh bowl_mesh(const BowlShape& s) {
  return turned(bowl_profile(s));
}

Profile mug_profile(const MugShape& s) {
  return vessel(s.radius, s.radius, s.height, s.wall, s.bottom);
}

Mesh mug_mesh(const MugShape& s) {
  const double middle = s.radius - s.wall / 2;
  return merged({turned(mug_profile(s)), handle_mesh(s.handle, middle, middle)});
}

Mesh jug_mesh(const JugShape& s) {
  const Profile profile = vessel(s.bottom_radius, s.rim_radius, s.height, s.wall, s.bottom);
  // The lip: outside and inside move alike, so the wall keeps its thickness.
  const auto lip = [&](double angle, double z) {
    const double height = std::max(0.0, z / s.height - 0.7) / 0.3;
    const double sideways = std::remainder(angle - pi, 2.0 * pi) / 0.3;
    return 1.0 + s.spout / s.rim_radius * height * height * std::exp(-0.5 * sideways * sideways);
  };
  const auto middle = [&](double z) {
    return s.bottom_radius + (s.rim_radius - s.bottom_radius) * z / s.height - s.wall / 2;
  };
  return merged({turned(profile, lip), handle_mesh(s.handle, middle(s.handle.top), middle(s.handle.bottom))});
}

Mesh carton_mesh(const CartonShape& s) {
  return box(s.size, s.size.maxCoeff() / 12);
}

Mesh tin_mesh(const TinShape& s) {
  const int segments = s.sides * ((turned_sides + s.sides - 1) / s.sides);  // a vertex at every corner
  const Profile profile{{0.0, 0.0}, {s.radius, 0.0}, {s.radius, s.height}, {0.0, s.height}};
  return revolve(subdivided(profile, up_the_side), segments, polygon_section(s.sides));
}

Mesh spray_bottle_mesh(const SprayBottleShape& s) {
  const double shoulder = 0.6 * s.height, neck = 0.76 * s.height, head = 0.82 * s.height;
  const Profile corners{
      {0.0, 0.0}, {s.half_width, 0.0}, {s.half_width, shoulder}, {0.015, neck}, {0.0, neck}};
  const double flat = s.half_depth / s.half_width;
  const double head_height = s.height - head;
  const std::vector<Eigen::Vector2d> nozzle{
      {0.05, head + 0.6 * head_height}, {0.06, head + 0.6 * head_height}, {0.072, head + 0.6 * head_height}};
  std::vector<Eigen::Vector2d> trigger;
  for (int i = 0; i <= 8; ++i) {
    const double t = i / 8.0;
    trigger.emplace_back(0.03 + 0.012 * std::sin(pi * t * 0.8) + 0.006 * t, head + 0.005 - 0.055 * t);
  }
  return merged({scaled(turned(rounded(corners, 0.015)), {1.0, flat, 1.0}),
                 moved(frustum(0.016, 0.016, head - neck + 0.006), shift(0, 0, neck - 0.003)),
                 moved(box({0.09, 0.026, head_height}, 0.012), shift(0.012, 0, head)),
                 tube(nozzle, 0.008, 0.008, 16), tube(trigger, 0.008, 0.004, 12)});
}

Mesh drill_mesh(const DrillShape& s) {
  constexpr double barrel = 0.029, battery = 0.045;
  const double axis = s.height - barrel;
  // A profile turned about z, laid along x.
  const auto lying = [&](Profile profile, double x) {
    Eigen::Isometry3d pose = shift(x, 0.0, axis);
    pose.linear() = Eigen::AngleAxisd(pi / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
    return moved(turned(profile), pose);
  };
  const double body = 0.72 * s.length, chuck = s.length - body;
  const double back = -0.45 * s.length;
  const Profile corners{{0.0, 0.0}, {barrel - edge, 0.0}, {barrel, 0.02}, {barrel, body}, {0.0, body}};
  const std::vector<Eigen::Vector2d> grip{
      {-0.012, battery - 0.004}, {-0.014, 0.5 * (battery + axis)}, {-0.02, axis}};
  const std::vector<Eigen::Vector2d> trigger{
      {0.0, axis - 0.045}, {0.008, axis - 0.042}, {0.014, axis - 0.036}};
  return merged({box({0.12, 0.07, battery}, 0.015), tube(grip, 0.018, 0.022, 32),
                 tube(trigger, 0.008, 0.014, 16), lying(rounded(corners, 0.01), back),
                 lying({{0.0, 0.0}, {0.021, 0.0}, {0.016, chuck}, {0.0, chuck}}, back + body)});
}

namespace {

struct Entry {
  std::string name;
  std::function<Mesh()> mesh;
  Symmetry symmetry;
};

const std::vector<Entry>& catalogue() {
  static const std::vector<Entry> entries{
      {"bottle", [] { return bottle_mesh(); }, Symmetry::continuous()},
      {"bowl", [] { return bowl_mesh(); }, Symmetry::continuous()},
      {"can", [] { return can_mesh(); }, Symmetry::continuous()},
      {"carton", [] { return carton_mesh(); }, Symmetry::n_fold(2)},
      {"drill", [] { return drill_mesh(); }, Symmetry::none()},
      {"glass", [] { return glass_mesh(); }, Symmetry::continuous()},
      {"jar", [] { return jar_mesh(); }, Symmetry::continuous()},
      {"jug", [] { return jug_mesh(); }, Symmetry::none()},
      {"mug", [] { return mug_mesh(); }, Symmetry::none()},
      {"spray_bottle", [] { return spray_bottle_mesh(); }, Symmetry::none()},
      {"tea_box",
       [] {
         return carton_mesh({.size = {0.08, 0.08, 0.095}});
       },
       Symmetry::n_fold(4)},
      {"tin", [] { return tin_mesh(); }, Symmetry::n_fold(6)},
  };
  return entries;
}

}  // namespace

const std::vector<std::string>& household_model_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Entry& entry : catalogue()) all.push_back(entry.name);
    return all;
  }();
  return names;
}

SceneModel household_model(std::string_view name) {
  for (const Entry& entry : catalogue())
    if (entry.name == name) return {entry.name, entry.mesh(), entry.symmetry, 0.0};
  throw InputError(fmt::format("no household model is called '{}'; there are: {}", name,
                               fmt::join(household_model_names(), ", ")));
}

}  // namespace perch
