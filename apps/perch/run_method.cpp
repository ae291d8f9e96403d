#include "run_method.hpp"

#include <fmt/format.h>

#include <optional>

#include "perch/baselines/bfwor.hpp"
#include "perch/core/error.hpp"
#include "perch/core/stopwatch.hpp"
#include "perch/io/message.hpp"
#include "perch/localize/given_poses.hpp"
#include "perch/localize/localize.hpp"
#ifdef PERCH_HAS_OUR_CVFH
#include "perch/baselines/our_cvfh.hpp"
#endif
#ifdef PERCH_HAS_PPF
#include "perch/baselines/ppf.hpp"
#endif

namespace perch::app {
namespace {

/// What a method that this program may have been built without needs.
struct Component {
  bool built;
  const char *option, *packages;
};

std::optional<Component> component_of(LocalizationMethod method) {
#ifdef PERCH_HAS_PPF
  constexpr bool has_ppf = true;
#else
  constexpr bool has_ppf = false;
#endif
#ifdef PERCH_HAS_OUR_CVFH
  constexpr bool has_our_cvfh = true;
#else
  constexpr bool has_our_cvfh = false;
#endif
  if (method == LocalizationMethod::ppf)
    return Component{has_ppf, "PERCH_OPENCV", "libopencv-dev and libopencv-contrib-dev"};
  if (method == LocalizationMethod::ourcvfh) return Component{has_our_cvfh, "PERCH_PCL", "libpcl-dev"};
  return std::nullopt;
}

#ifdef PERCH_HAS_OUR_CVFH
OurCvfhSettings our_cvfh_settings(const Settings& settings) {
  OurCvfhSettings own;
  own.refine = settings.candidates.refine;
  return own;
}
#endif

/// The baselines don't choose among rest orientations.
void refuse_rest_poses(const Scene& scene, LocalizationMethod method) {
  for (const SceneObject& object : scene.objects)
    if (rest_pose_count(scene.models, object.model) > 1)
      throw InputError(fmt::format(
          "models.{}.rest_poses: has several entries, and {} takes each model in one orientation; list one, "
          "or use --method perch",
          one_line(scene.models[object.model].name), name(method)));
}

BaselineAnswer run_baseline(const Scene& scene, const Settings& settings, const Executor& executor,
                            const StopCondition& stop) {
  const CandidateSettings& common = settings.candidates;
#ifdef PERCH_HAS_OUR_CVFH
  if (settings.localization == LocalizationMethod::ourcvfh)
    return our_cvfh(scene, our_cvfh_settings(settings), executor, stop);
#endif
#ifdef PERCH_HAS_PPF
  if (settings.localization == LocalizationMethod::ppf) {
    PpfSettings ppf_settings;
    ppf_settings.cost = common.cost;
    ppf_settings.refine = common.refine;
    ppf_settings.collision = common.collision;
    return ppf(scene, ppf_settings, executor, stop);
  }
#endif
  return bfwor(scene, {common.grid, common.refine, common.collision, settings.bfwor_distance_limit}, executor,
               stop);
}

}  // namespace

void check_built(LocalizationMethod method) {
  const auto component = component_of(method);
  if (component && !component->built)
    throw InvalidSetting(fmt::format(
        "--method: {} is not built in; install {} (script/bootstrap --baselines) and configure with -D{}=ON",
        name(method), component->packages, component->option));
}

void learn_models([[maybe_unused]] const Scene& scene, [[maybe_unused]] const Settings& settings,
                  [[maybe_unused]] const Executor& executor) {
#ifdef PERCH_HAS_OUR_CVFH
  if (settings.localization == LocalizationMethod::ourcvfh)
    train_our_cvfh(scene, our_cvfh_settings(settings), executor, StopCondition());
#endif
}

Result run_method(const Scene& scene, const Settings& settings, const Executor& executor,
                  const StopCondition& stop, const std::function<void(const Progress&)>& on_progress) {
  if (settings.localization == LocalizationMethod::perch)
    return localize(scene, settings, executor, stop, on_progress);
  refuse_rest_poses(scene, settings.localization);
  const Stopwatch watch;
  Progress progress;
  progress.stage = "poses";
  if (on_progress) on_progress(progress);
  BaselineAnswer answer;
  try {
    answer = run_baseline(scene, settings, executor, stop);
  } catch (const Interrupted&) {
    answer.stopped = true;
  }
  const double seconds = watch.seconds();
  Result result = report_given_poses(scene, answer.poses, answer.stopped, settings, executor);
  result.stats.rendered = answer.hypotheses;
  result.stats.seconds.total = seconds;
  for (TraceEntry& entry : result.trace) entry.seconds = seconds;
  return result;
}

}  // namespace perch::app
