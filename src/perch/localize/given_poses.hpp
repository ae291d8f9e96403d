#pragma once

#include <optional>
#include <vector>

#include "perch/localize/result.hpp"
#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"
#include "perch/parallel/executor.hpp"

namespace perch {

/// The result of a method that gives poses and proves nothing: their flat cost and what is visible of each
/// object; no bound and no guarantee. The method is the settings'. \param poses of Scene::objects, in their
/// order and of the first bodies of their models; an object without one is absent. None at all where the
/// clock struck before anything was found. \param stopped the clock struck. Throws what make_problem throws.
Result report_given_poses(const Scene& scene, const std::vector<std::optional<Pose>>& poses, bool stopped,
                          const Settings& settings, const Executor& executor);

}  // namespace perch
