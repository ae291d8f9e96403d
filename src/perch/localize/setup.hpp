#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "perch/candidates/priors.hpp"
#include "perch/candidates/problem.hpp"
#include "perch/localize/result.hpp"
#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"

namespace perch {

/// The settings of the cost for a scene: with clutter where it says so. Throws InputError where the scene
/// asks for what that cost can't tell.
CostSettings cost_settings(const Scene& scene, const Settings& settings);

/// What a result says of how clutter was counted.
std::optional<Guarantee::Clutter> clutter_of(const Scene& scene, const Settings& settings);

/// A scene made ready to be searched or scored. Throws InputError, Interrupted.
std::unique_ptr<LocalizationProblem> make_problem(const Scene& scene, const Settings& settings,
                                                  const Executor& executor,
                                                  const StopCondition& stop = StopCondition());

/// The scene's priors for the problem's models; one for an object that may be absent guides that entry too.
std::vector<PriorPose> priors_of(const Scene& scene, const LocalizationProblem& problem);

}  // namespace perch
