#include "perch/localize/localize.hpp"

#include <fmt/format.h>

#include "perch/core/stopwatch.hpp"
#include "perch/localize/ambiguity.hpp"
#include "perch/localize/exhaustive.hpp"
#include "perch/localize/polish.hpp"
#include "perch/localize/report.hpp"
#include "perch/localize/scene_search.hpp"
#include "perch/localize/services.hpp"
#include "perch/localize/setup.hpp"

namespace perch {
namespace {

/// The set of scenes that the bound holds for.
std::string range_of(const Scene& scene, const Settings& settings) {
  if (settings.mode == CandidateMode::context)
    return "grid poses after ICP in the context of their parent scene; scenes of the monotone scene "
           "generation "
           "tree; the bound counts placed objects only, since nothing is known of where ICP may still go";
  const std::string poses = settings.candidates.refine.method == RefineMethod::icp
                                ? "fixed candidates: grid poses after ICP alone"
                                : "fixed candidates: grid poses";
  return poses +
         (cost_settings(scene, settings).charges_points() ? ""
                                                          : ", with the middle of each object in the image") +
         (settings.search_method() == SearchMethod::branch_and_bound
              ? "; all collision-free scenes of these, mutual occlusion included"
              : "; scenes of these in the monotone scene generation tree");
}

void describe_guarantee(const Scene& scene, const Settings& settings, Guarantee& g) {
  g.w = settings.w;
  g.over = range_of(scene, settings);
  g.delta = settings.candidates.cost.delta;
  g.missing_depth = name(settings.candidates.cost.missing_depth);
  g.clutter = clutter_of(scene, settings);
  g.collision_penetration = settings.candidates.collision.penetration;
  g.collision_overlap = settings.candidates.collision.overlap;
  g.resolution_m = settings.candidates.grid.resolution;
  g.yaw_resolution_rad = settings.candidates.grid.yaw_resolution;
  g.refine = name(settings.candidates.refine.method);
  g.search = settings.exhaustive ? "exhaustive" : name(settings.search_method());
}

/// One run of the method; each step fills in its part of the result.
class Localization {
 public:
  Localization(const Scene& scene, const Settings& settings, const Executor& executor,
               const StopCondition& stop, const std::function<void(const Progress&)>& on_progress)
      : scene_(scene),
        settings_(settings),
        executor_(executor),
        stop_(stop),
        search_stop_(StopCondition::before(stop, 0.1, 3.0)),
        log_(on_progress),
        problem_(make_told_problem()),
        priors_(priors_of(scene, *problem_)),
        makers_(make_makers(*problem_, executor)),
        candidates_(*problem_, makers_, executor) {}

  Result run() {
    result_.observed_points = static_cast<std::int64_t>(problem_->observation().size());
    describe_guarantee(scene_, settings_, result_.guarantee);
    result_.support = support_of(scene_);
    if (settings_.mode == CandidateMode::context) {
      const Stopwatch watch;
      take(search_in_context(*problem_, candidates_, makers_, priors_, settings_, executor_, search_stop_,
                             log_, result_.stats.rendered));
      result_.guarantee.candidates = static_cast<std::int64_t>(candidates_.set().size());
      result_.stats.seconds.search = watch.seconds();
    } else if (make_candidates()) {
      const Stopwatch watch;
      take(settings_.exhaustive ? enumerate()
                                : search_fixed(*problem_, candidates_, makers_, priors_, settings_, executor_,
                                               search_stop_, log_));
      result_.stats.seconds.search = watch.seconds();
    }
    name_rest_poses();
    finish();
    return result_;
  }

 private:
  /// All processes make it at the same time.
  std::unique_ptr<LocalizationProblem> make_told_problem() const {
    tell_problem(scene_, settings_, executor_);
    return make_problem(scene_, settings_, executor_, stop_);
  }

  /// Says so where the bound ranges over several ways to rest.
  void name_rest_poses() {
    for (std::size_t kind = 0; kind < problem_->kinds(); ++kind)
      if (problem_->copies()[kind] > 0 && problem_->bodies_of(kind).size() > 1) {
        result_.guarantee.over += "; every listed rest pose of each model";
        return;
      }
  }

  /// False where there is nothing to search.
  bool make_candidates() {
    log_.stage("candidates");
    const Stopwatch watch;
    const bool lazily = !settings_.exhaustive && settings_.search_method() == SearchMethod::branch_and_bound;
    const bool complete = candidates_.refine(search_stop_) && (lazily || candidates_.value_all(search_stop_));
    result_.stats.seconds.candidates = watch.seconds();
    result_.stats.rendered = candidates_.hypotheses();
    result_.guarantee.candidates = candidates_.count();
    if (!complete) {
      result_.status = Status::time_limit;
      result_.reason = "the time limit came while candidates were made";
      return false;
    }
    if (const auto reason = object_without_pose()) {
      result_.status = Status::infeasible;
      result_.reason = *reason;
      return false;
    }
    return true;
  }

  std::optional<std::string> object_without_pose() const {
    std::vector<char> open(problem_->kinds(), 0);
    for (const FixedCandidates::Hypothesis& hypothesis : candidates_.open())
      open[problem_->kind_of(hypothesis.model)] = 1;
    for (std::size_t kind = 0; kind < problem_->kinds(); ++kind) {
      if (problem_->copies()[kind] == 0 || open[kind] || !candidates_.set().of_kind(kind).empty()) continue;
      double poses = 0.0;
      for (const std::size_t model : problem_->bodies_of(kind)) poses += problem_->grid(model).size();
      return fmt::format("{} has no valid pose: at none of its {:.0f} grid poses is any of it in view",
                         problem_->models()[problem_->bodies_of(kind).front()].name(), poses);
    }
    return std::nullopt;
  }

  SearchOutcome enumerate() {
    log_.stage("enumeration");
    const bool all = settings_.search_method() == SearchMethod::branch_and_bound;
    const Enumeration found = enumerate_scenes(*problem_, candidates_.set(), makers_, executor_,
                                               all ? nullptr : &settings_.tree, search_stop_);
    SearchOutcome outcome;
    outcome.generated = outcome.expanded = static_cast<std::uint64_t>(found.scenes);
    if (found.best) outcome.scenes.push_back(*found.best);
    outcome.reason = !found.complete ? (stop_.cancelled() ? StopReason::cancelled : StopReason::time)
                     : found.best    ? StopReason::solved
                                     : StopReason::infeasible;
    if (found.best && found.complete) outcome.lower_bound = found.best->cost;
    log_.counts(outcome.generated, outcome.expanded);
    if (found.best) log_.improved(found.best->cost, outcome.lower_bound);
    return outcome;
  }

  void take(const SearchOutcome& found) {
    result_.stats.generated = static_cast<std::int64_t>(found.generated);
    result_.stats.expanded = static_cast<std::int64_t>(found.expanded);
    result_.lower_bound = found.lower_bound;
    scenes_ = found.scenes;
    if (!scenes_.empty()) result_.search_cost = scenes_.front().cost;
    describe(found.reason);
  }

  /// Solved is what is within w of the bound, whatever the reason of the stop.
  void describe(StopReason reason) {
    const bool solved = result_.search_cost && static_cast<double>(*result_.search_cost) <=
                                                   settings_.w * static_cast<double>(result_.lower_bound);
    if (solved) {
      result_.status = Status::solved;
      result_.reason = *result_.search_cost == result_.lower_bound
                           ? "no scene costs less"
                           : fmt::format("the scene costs at most {} times the optimum", settings_.w);
    } else if (reason == StopReason::infeasible) {
      result_.status = Status::infeasible;
      result_.reason = object_without_pose().value_or(
          settings_.search_method() == SearchMethod::branch_and_bound
              ? "no arrangement of all objects on this grid is free of collisions"
              : "no arrangement of all objects on this grid is free of collisions and monotone");
    } else {
      result_.status = Status::time_limit;
      result_.reason =
          fmt::format("the search was stopped by its limit ({}) before the bound was proven", name(reason));
    }
  }

  std::vector<PlacedModel> placed(const std::vector<CandidateId>& candidates) const {
    std::vector<PlacedModel> objects;
    for (const CandidateId id : candidates)
      if (!candidates_.set()[id].absent)
        objects.push_back({candidates_.set()[id].model, candidates_.set()[id].pose});
    return in_scene_order(*problem_, std::move(objects));
  }

  /// The scene reported: the one found and other good ones refined off the grid, and how sure each pose is.
  void polish_and_judge() {
    log_.stage("polish");
    const Stopwatch watch;
    std::vector<ArrangedScene> starts;
    for (const CandidateScene& scene : scenes_) starts.push_back({placed(scene.candidates), scene.cost});
    ArrangedScene best = polish_best(*problem_, makers_, executor_, starts, settings_.polish, stop_);
    const JudgedScene judged = judge(*problem_, candidates_, makers_, executor_, std::move(best),
                                     settings_.ambiguity, settings_.polish, stop_);
    report_search(*problem_, starts.front().placed, result_);
    report_judged(*problem_, judged, result_);
    result_.stats.seconds.polish = watch.seconds();
    log_.polished(result_.cost->cost, *result_.search_cost, result_.lower_bound);
  }

  void finish() {
    if (result_.search_cost) polish_and_judge();
    Effort effort;
    for (const CandidateMaker& maker : makers_) effort += maker.effort();
    result_.stats.work = effort.work;
    result_.stats.made_again = effort.made_again;
    Seconds& seconds = result_.stats.seconds;
    seconds.render = effort.seconds.render;
    seconds.refine = effort.seconds.refine;
    seconds.cost = effort.seconds.cost;
    seconds.total = watch_.seconds();
    result_.stats.threads = static_cast<int>(executor_.workers());
    result_.stats.ranks = static_cast<int>(executor_.processes());
    result_.trace = log_.trace();
  }

  const Stopwatch watch_;
  const Scene& scene_;
  const Settings& settings_;
  const Executor& executor_;
  const StopCondition& stop_;
  const StopCondition search_stop_;  // leaves time to polish and to judge what was found
  ProgressLog log_;
  std::unique_ptr<LocalizationProblem> problem_;
  std::vector<PriorPose> priors_;
  std::vector<CandidateMaker> makers_;
  FixedCandidates candidates_;
  std::vector<CandidateScene> scenes_;  // the best one and other good ones
  Result result_;
};

}  // namespace

Result localize(const Scene& scene, const Settings& settings, const Executor& executor,
                const StopCondition& stop, const std::function<void(const Progress&)>& on_progress) {
  settings.check();
  settings.check_together();
  const Stopwatch watch;
  try {
    return Localization(scene, settings, executor, stop, on_progress).run();
  } catch (const Interrupted&) {
    Result result;
    result.status = Status::time_limit;
    result.reason = "the time limit came while the observation was prepared";
    result.observed_points =
        static_cast<std::int64_t>(Observation(scene.camera, scene.depth, scene.mask).size());
    describe_guarantee(scene, settings, result.guarantee);
    result.support = support_of(scene);
    result.stats.threads = static_cast<int>(executor.workers());
    result.stats.ranks = static_cast<int>(executor.processes());
    result.stats.seconds.total = watch.seconds();
    return result;
  }
}

std::vector<ScoreRecord> score(const Scene& scene, const std::vector<std::vector<PlacedModel>>& arrangements,
                               const Settings& settings, const Executor& executor) {
  const auto problem = make_problem(scene, settings, executor);
  std::vector<ScoreRecord> records(arrangements.size());
  executor.for_each(
      records.size(),
      [&](std::size_t i, std::size_t) { records[i] = score_scene(*problem, arrangements[i], settings.tree); },
      StopCondition());
  return records;
}

}  // namespace perch
