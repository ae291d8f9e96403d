#pragma once

#include <string>

#include "perch/core/stop.hpp"
#include "perch/localize/result.hpp"
#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"
#include "perch/parallel/executor.hpp"

namespace perch::app {

/// What the command ends with after such a result, where nothing worse came before it.
int exit_status(Status status);

/// The result for people, on stdout.
void print_table(const Scene& scene, const Result& result);

/// The scene localized by the method that the settings name, with a line of progress unless `quiet`. Throws
/// InputError that begins with `blamed`.
Result localize_with_progress(const Scene& scene, const Settings& settings, const Executor& executor,
                              const StopCondition& stop, bool quiet, const std::string& blamed);

}  // namespace perch::app
