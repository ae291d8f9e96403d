#pragma once

#include <vector>

#include "perch/candidates/problem.hpp"
#include "perch/localize/ambiguity.hpp"
#include "perch/localize/result.hpp"
#include "perch/localize/scene.hpp"
#include "perch/tree/monotone.hpp"

namespace perch {

/// The poses in the order of the problem's objects; repeats of a kind by ascending x, then y, then yaw.
/// The same for every order that they are given in.
std::vector<PlacedModel> in_scene_order(const LocalizationProblem& problem, std::vector<PlacedModel> placed);

/// Which of its model's orientations a body is; empty where the model has one.
std::optional<int> rest_pose(const LocalizationProblem& problem, std::size_t body);

/// Fills in what the search found. \param placed one pose for each object, in any order.
void report_search(const LocalizationProblem& problem, const std::vector<PlacedModel>& placed,
                   Result& result);

/// Fills in what a result says of its scene: objects in the order of the problem's, costs, visible and
/// explained fractions. \param placed one pose for each object that is not
/// absent, in any order.
void report_scene(const LocalizationProblem& problem, const std::vector<PlacedModel>& placed, Result& result);

/// report_scene with the confidence and runner-up of each object, where judged.
void report_judged(const LocalizationProblem& problem, const JudgedScene& judged, Result& result);

/// The record of one given scene; any number of objects.
ScoreRecord score_scene(const LocalizationProblem& problem, const std::vector<PlacedModel>& placed,
                        const MonotoneSettings& settings);

}  // namespace perch
