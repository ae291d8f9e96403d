#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "perch/localize/scene.hpp"

namespace perch {

// Chess pieces of the Staunton kind. Heights (king 95 mm, queen 85, bishop 70, knight 60, rook 55, pawn 50)
// and bases of 40 to 50 % of them after FIDE, "Standards of Chess Equipment", 2022. Pawn, rook, bishop and
// queen are solids of revolution: the rook has no crenels, the bishop no notch, the queen no points, so that
// their symmetry is exact. The king bears a cross (2-fold); the knight looks along x (none).

/// Side of a board's square, metres; FIDE: 5 to 6 cm, the king's base covering about three quarters of it.
inline constexpr double chess_square = 0.055;

/// bishop, king, knight, pawn, queen, rook.
const std::vector<std::string>& chess_model_names();

/// A piece by name. Throws InputError for a name not in chess_model_names().
SceneModel chess_model(std::string_view name);

}  // namespace perch
