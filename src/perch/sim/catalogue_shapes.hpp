#pragma once

#include "perch/model/mesh.hpp"
#include "perch/sim/shape_parts.hpp"

namespace perch {

// More shapes of household objects, made like those of parametric_models.hpp: closed meshes that stand on z =
// 0, z up, metres; spouts and single handles along x.

/// A can whose ends are alike: 2-fold on its side.
Mesh even_can_mesh(double radius, double height);

/// A plate with a flat middle and a rising rim; continuous symmetry.
Mesh plate_mesh(double radius, double middle_radius, double height);

/// A wine glass: foot, stem and a hollow bowl; continuous symmetry.
Mesh goblet_mesh();

/// A vase with a waist, hollow; continuous symmetry.
Mesh vase_mesh();

/// A pepper mill: a turned solid with a knob; continuous symmetry.
Mesh mill_mesh();

/// A carton of milk with a gable for its top; 2-fold. \param width along x, along the gable's ridge.
Mesh gabled_carton_mesh(double width, double depth, double height);

/// A bottle of elliptic section with a cap on top; 2-fold. \param tip radius of the cap's top: less than its
/// foot makes a nozzle.
struct FlatBottleShape {
  double half_width = 0.042, half_depth = 0.022, height = 0.2;
  double cap_radius = 0.016, cap_height = 0.025, tip_radius = 0.016;
};
Mesh flat_bottle_mesh(const FlatBottleShape& shape);

/// A low dish with rounded corners; 2-fold.
Mesh dish_mesh(double half_width, double half_depth, double height);

/// A cup with a handle on either side; 2-fold.
Mesh soup_cup_mesh();

/// A saucepan with one straight handle; no symmetry.
Mesh saucepan_mesh();

/// A teapot: round body with a lid, spout along -x, handle along x; no symmetry.
Mesh teapot_mesh();

/// A watering can: closed body, long spout along -x, handle along x; no symmetry.
Mesh watering_can_mesh();

/// A jug of detergent: elliptic body, cap and a handle that leaves a hole; no symmetry.
Mesh detergent_mesh();

}  // namespace perch
