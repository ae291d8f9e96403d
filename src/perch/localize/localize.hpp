#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "perch/core/stop.hpp"
#include "perch/localize/progress.hpp"
#include "perch/localize/result.hpp"
#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"
#include "perch/parallel/executor.hpp"

namespace perch {

/// Finds the pose of every object of a scene: the cheapest explanation up to the factor w, with the bound
/// proven for it. \param stop when it strikes, the best scene found so far is the answer, with status
/// time_limit. \param on_progress called on the calling thread; may be empty. Throws InputError for a scene
/// or settings that can't be used.
Result localize(const Scene& scene, const Settings& settings, const Executor& executor,
                const StopCondition& stop, const std::function<void(const Progress&)>& on_progress = {});

/// The flat cost of given scenes, one record each, in order.
std::vector<ScoreRecord> score(const Scene& scene, const std::vector<std::vector<PlacedModel>>& arrangements,
                               const Settings& settings, const Executor& executor);

/// World height of the support plane: the scene's, or an estimate from the lowest observed points.
double table_height(const Scene& scene);

}  // namespace perch
