#pragma once

#include <string>

#include "perch/core/bytes.hpp"
#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"
#include "perch/parallel/executor.hpp"
#include "perch/parallel/serve.hpp"

namespace perch {

/// What a process does that shares in the localization that another runs.
Services localization_services();

/// Lets the services of all other processes make the problem that make_problem makes of this.
void tell_problem(const Scene& scene, const Settings& settings, const Executor& executor);

}  // namespace perch
