#pragma once

#include <functional>

#include "perch/core/stop.hpp"
#include "perch/localize/progress.hpp"
#include "perch/localize/result.hpp"
#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"
#include "perch/parallel/executor.hpp"

namespace perch::app {

/// Throws InvalidSetting, which says how to build it, for a method that this program was built without.
void check_built(LocalizationMethod method);

/// What the method learns of the models once and keeps for later runs, without a time limit: OUR-CVFH fills
/// its cache. Throws InputError.
void learn_models(const Scene& scene, const Settings& settings, const Executor& executor);

/// The scene localized by the method that the settings name; the same result whoever made it. Throws
/// InputError.
Result run_method(const Scene& scene, const Settings& settings, const Executor& executor,
                  const StopCondition& stop, const std::function<void(const Progress&)>& on_progress);

}  // namespace perch::app
