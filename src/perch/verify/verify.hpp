#pragma once

#include "perch/io/result_file.hpp"
#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"
#include "perch/verify/check.hpp"

namespace perch {

/// The settings that a result states its costs were counted with, all others at their defaults. Throws
/// InvalidSetting where one is out of its range.
Settings stated_settings(const Guarantee& guarantee);

/// Checks what a result states of its scene, by other means than those that made it: rays cast by Embree, in
/// double where it matters, distances by a k-d tree, solids by rays and exact distances. Everything that
/// follows from the scene and the poses is computed anew; the lower bound is not. \param settings delta,
/// missing depth and collisions. Throws InputError where nothing was observed.
Checks verify(const Scene& scene, const ReportedResult& result, const Settings& settings);

}  // namespace perch
