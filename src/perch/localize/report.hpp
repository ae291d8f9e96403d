#pragma once

#include <vector>

#include "perch/candidates/problem.hpp"
#include "perch/localize/result.hpp"
#include "perch/localize/scene.hpp"
#include "perch/tree/monotone.hpp"

namespace perch {

/// Fills in what a result says of its scene: objects in the order of the problem's, costs, visible and
/// explained fractions. \param placed one pose for each object, in any order.
void report_scene(const LocalizationProblem& problem, const std::vector<PlacedModel>& placed, Result& result);

/// The record of one given scene; any number of objects.
ScoreRecord score_scene(const LocalizationProblem& problem, const std::vector<PlacedModel>& placed,
                        const MonotoneSettings& settings);

}  // namespace perch
