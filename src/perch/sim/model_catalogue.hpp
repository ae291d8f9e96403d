#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "perch/localize/scene.hpp"

namespace perch {

/// The wider set of household objects: those of household_model_names() and more, in a fixed order. Some are
/// others on their heads (NAME_upside_down) or on their sides (NAME_lying), turned and never mirrored.
const std::vector<std::string>& catalogue_model_names();

/// A model of the catalogue by name, with the symmetry that a depth camera sees. Throws InputError for a name
/// not in catalogue_model_names().
SceneModel catalogue_model(std::string_view name);

/// A model of the catalogue or a chess piece. Throws InputError for any other name.
SceneModel named_model(std::string_view name);

}  // namespace perch
