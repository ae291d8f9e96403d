#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "perch/localize/scene.hpp"
#include "perch/model/mesh.hpp"
#include "perch/sim/mesh_builder.hpp"
#include "perch/sim/shape_parts.hpp"

namespace perch {

// Household objects from a few dimensions, all in metres: closed meshes that stand on z = 0, z up, of 500 to
// 5,000 triangles with the dimensions given here. The axis of what is turned is the z axis; handles and
// spouts point along x.

/// A food can with a sunk lid; continuous symmetry.
struct CanShape {
  double radius = 0.037, height = 0.11;
};
Profile can_profile(const CanShape& shape);
Mesh can_mesh(const CanShape& shape = {});

/// A bottle with a cap; continuous symmetry.
struct BottleShape {
  double radius = 0.036, height = 0.25;
  double neck_radius = 0.013;
  double shoulder = 0.15;  ///< height at which the body begins to narrow
};
Profile bottle_profile(const BottleShape& shape);
Mesh bottle_mesh(const BottleShape& shape = {});

/// A jar whose lid is wider than its neck; continuous symmetry.
struct JarShape {
  double radius = 0.045, height = 0.125;
  double lid_radius = 0.039, lid_height = 0.018;
};
Profile jar_profile(const JarShape& shape);
Mesh jar_mesh(const JarShape& shape = {});

/// A hollow vessel with a flat bottom and straight walls; a drinking glass; continuous symmetry.
struct GlassShape {
  double bottom_radius = 0.029, rim_radius = 0.037, height = 0.135;
  double wall = 0.003, bottom = 0.008;
};
Profile glass_profile(const GlassShape& shape);
Mesh glass_mesh(const GlassShape& shape = {});

/// A bowl: a quarter of an ellipse on a foot, with an inside; continuous symmetry.
struct BowlShape {
  double radius = 0.08, height = 0.07, foot_radius = 0.035, wall = 0.004;
};
Profile bowl_profile(const BowlShape& shape);
Mesh bowl_mesh(const BowlShape& shape = {});

/// A mug; no symmetry. The handle is a closed tube of its own that ends inside the wall.
struct MugShape {
  double radius = 0.042, height = 0.098, wall = 0.005, bottom = 0.008;
  HandleShape handle{.top = 0.077, .bottom = 0.025, .reach = 0.033};
};
Profile mug_profile(const MugShape& shape);
Mesh mug_mesh(const MugShape& shape = {});

/// A pitcher with a handle along x and a spout along -x; no symmetry.
struct JugShape {
  double bottom_radius = 0.058, rim_radius = 0.050, height = 0.2, wall = 0.005, bottom = 0.01;
  double spout = 0.022;  ///< how far the lip reaches beyond the rim
  HandleShape handle{
      .top = 0.155, .bottom = 0.055, .reach = 0.05, .half_width = 0.010, .half_thickness = 0.006};
};
Mesh jug_mesh(const JugShape& shape = {});

/// A carton box; 2-fold where its sides differ, 4-fold where they are equal.
struct CartonShape {
  Eigen::Vector3d size{0.15, 0.055, 0.2};
};
Mesh carton_mesh(const CartonShape& shape = {});

/// A tin with a polygon for its ground plan; as many-fold as it has sides.
struct TinShape {
  int sides = 6;
  double radius = 0.05, height = 0.09;  ///< radius to the corners
};
Mesh tin_mesh(const TinShape& shape = {});

/// A spray bottle: elliptic body, collar, head, nozzle and trigger, each a closed component; no symmetry.
struct SprayBottleShape {
  double half_width = 0.045, half_depth = 0.029, height = 0.26;
};
Mesh spray_bottle_mesh(const SprayBottleShape& shape = {});

/// A cordless drill on its battery: battery, grip, trigger, body and chuck, each a closed component; no
/// symmetry.
struct DrillShape {
  double length = 0.19, height = 0.21;
};
Mesh drill_mesh(const DrillShape& shape = {});

/// The names of the models that household_model makes, in a fixed order.
const std::vector<std::string>& household_model_names();

/// A model by name, in its default shape, with the symmetry that a depth camera sees. Throws InputError for a
/// name not in household_model_names().
SceneModel household_model(std::string_view name);

}  // namespace perch
