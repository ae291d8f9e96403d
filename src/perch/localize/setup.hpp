#pragma once

#include <memory>

#include "perch/candidates/problem.hpp"
#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"

namespace perch {

/// A scene made ready to be searched or scored. Throws InputError, Interrupted.
std::unique_ptr<LocalizationProblem> make_problem(const Scene& scene, const Settings& settings,
                                                  const Executor& executor,
                                                  const StopCondition& stop = StopCondition());

}  // namespace perch
