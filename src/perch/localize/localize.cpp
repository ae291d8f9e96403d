#include "perch/localize/localize.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "perch/candidates/first_scenes.hpp"
#include "perch/candidates/lagrangian_bound.hpp"
#include "perch/core/stopwatch.hpp"
#include "perch/heuristics/heuristics.hpp"
#include "perch/localize/report.hpp"
#include "perch/localize/setup.hpp"
#include "perch/search/focal_mha.hpp"
#include "perch/tree/scene_tree.hpp"

namespace perch {
namespace {

constexpr int bound_iterations = 60;  // of the Lagrangian bound; most of what it gives comes in the first ten
constexpr int widening_rounds = 10;
constexpr std::size_t most_widened =
    4000;  // candidates that are rendered once more to widen their certain costs

void describe_guarantee(const Settings& settings, Guarantee& g) {
  const CandidateSettings& c = settings.candidates;
  const bool icp = c.refine.method == RefineMethod::icp, context = settings.mode == CandidateMode::context;
  g.w = settings.w;
  g.over = !icp      ? "scenes of the monotone scene generation tree over grid poses"
           : context ? "scenes of the monotone scene generation tree over grid poses after ICP in the "
                       "context of their parent scene"
                     : "scenes of the monotone scene generation tree over fixed candidates: grid poses "
                       "after ICP alone";
  g.resolution_m = c.grid.resolution;
  g.yaw_resolution_rad = c.grid.yaw_resolution;
  g.refine = name(c.refine.method);
  g.search = name(settings.method);
}

/// One run of the method; each step fills in its part of the result.
class Localization {
 public:
  Localization(const Scene& scene, const Settings& settings, const Executor& executor,
               const StopCondition& stop, const std::function<void(const Progress&)>& on_progress)
      : settings_(settings),
        executor_(executor),
        stop_(stop),
        on_progress_(on_progress),
        problem_(make_problem(scene, settings, executor, stop)),
        makers_(make_makers(*problem_, executor)),
        candidates_{CandidateSet(problem_->models().size()), 0, true} {}

  Result run() {
    result_.observed_points = static_cast<std::int64_t>(problem_->observation().size());
    describe_guarantee(settings_, result_.guarantee);
    if (settings_.mode == CandidateMode::context)
      search_in_context();
    else if (make_candidates())
      search_fixed();
    finish();
    return result_;
  }

 private:
  void report(const Progress& progress) const {
    if (on_progress_) on_progress_(progress);
  }

  /// False where there is nothing to search.
  bool make_candidates() {
    report({.stage = "candidates"});
    candidates_ = make_fixed_candidates(*problem_, makers_, executor_, stop_);
    result_.stats.rendered = candidates_.hypotheses;
    result_.guarantee.candidates = static_cast<std::int64_t>(candidates_.set.size());
    if (!candidates_.complete) {
      result_.status = Status::time_limit;
      result_.reason = "the time limit came while candidates were made";
      return false;
    }
    for (std::size_t model = 0; model < problem_->models().size(); ++model)
      if (problem_->copies()[model] > 0 && candidates_.set.of_model(model).empty()) {
        result_.status = Status::infeasible;
        result_.reason = no_pose(model);
        return false;
      }
    return true;
  }

  std::string no_pose(std::size_t model) const {
    return fmt::format("{} has no valid pose: at none of its {:.0f} grid poses is any of it in view",
                       problem_->models()[model].name(), problem_->grid(model).size());
  }

  void search_in_context() {
    const Stopwatch watch;
    SceneTree tree = SceneTree::in_context(*problem_, candidates_.set, makers_, executor_, settings_.tree);
    search(tree, std::nullopt);
    result_.stats.seconds.search = watch.seconds();
  }

  /// Over the fixed set: a first scene, then the candidates that no better scene can hold are dropped, then
  /// the tree over those left. What was dropped costs at least as much as the first scene, so the tree's
  /// bound holds for the whole set.
  void search_fixed() {
    const Stopwatch watch;
    report({.stage = "first scenes"});
    std::optional<Incumbent<SceneState>> first;
    {
      const SceneTree whole =
          SceneTree::fixed(*problem_, candidates_.set, makers_, executor_, settings_.tree);
      for (const CandidateScene& scene :
           first_scenes(*problem_, candidates_.set, makers_, executor_, stop_)) {
        if (!whole.contains(scene.candidates)) continue;
        first = Incumbent<SceneState>{whole.state_of(scene.candidates), static_cast<double>(scene.cost)};
        break;
      }
    }
    std::optional<ReducedCosts> reduced_costs;
    if (first) reduced_costs = drop_candidates(first->state);
    SceneTree tree = SceneTree::fixed(*problem_, candidates_.set, makers_, executor_, settings_.tree);
    if (reduced_costs) tree.use(*reduced_costs, static_cast<std::int64_t>(first->cost));
    search(tree, std::move(first));
    result_.stats.seconds.search = watch.seconds();
  }

  /// Returns what bounds the scenes of the candidates that it leaves.
  ReducedCosts drop_candidates(const SceneState& known) {
    const std::int64_t upper_bound = known.cost;
    report({.stage = "bound", .best_cost = upper_bound});
    LagrangianBound lagrangian(*problem_, candidates_.set);
    const double enough = static_cast<double>(upper_bound) / settings_.w;
    lagrangian.improve(bound_iterations, upper_bound, enough, executor_, stop_);
    for (int round = 0; round < widening_rounds; ++round) {
      const std::int64_t bound = lagrangian.lower_bound();
      const std::size_t kept = lagrangian.kept_count();
      if (stop_() || static_cast<double>(bound) >= enough || kept > most_widened) break;
      lagrangian.separate_copies(known.placed, bound_iterations, upper_bound, executor_, stop_);
      lagrangian.widen_certain(makers_, executor_);
      lagrangian.improve(bound_iterations, upper_bound, enough, executor_, stop_);
      if (lagrangian.lower_bound() == bound && lagrangian.kept_count() == kept) break;
    }
    candidates_.set.restrict_to(lagrangian.kept());
    return lagrangian.reduced_costs();
  }

  void search(SceneTree& tree, std::optional<Incumbent<SceneState>> first) {
    Heuristics<SceneState> heuristics;
    heuristics.admissible = bound_heuristic;
    heuristics.inadmissible = {DepthHeuristic(problem_->object_count()),
                               OverlapHeuristic(*problem_, candidates_.set)};
    FocalMhaOptions options;
    options.w = settings_.w;
    options.max_expansions = settings_.max_expansions;
    SearchObserver<SceneState> observer;
    if (on_progress_)
      observer.on_expansion = [this](const SearchProgress& p) {
        Progress progress{"search", p.generated, p.expanded, std::nullopt, bound_of(p.lower_bound)};
        if (p.incumbent_cost) progress.best_cost = static_cast<std::int64_t>(*p.incumbent_cost);
        report(progress);
      };
    const SearchResult<SceneState> found =
        focal_mha(tree, heuristics, options, stop_, std::move(first), observer);
    result_.stats.generated = static_cast<std::int64_t>(found.counters.generated);
    result_.stats.expanded = static_cast<std::int64_t>(found.counters.expanded);
    result_.stats.rendered += tree.hypotheses();
    if (settings_.mode == CandidateMode::context)
      result_.guarantee.candidates = static_cast<std::int64_t>(candidates_.set.size());
    if (found.incumbent) {
      scene_ = found.incumbent->state.placed;
      result_.search_cost = static_cast<std::int64_t>(found.incumbent->cost);
    }
    result_.lower_bound = std::isfinite(found.lower_bound) ? bound_of(found.lower_bound) : 0;
    describe(found);
  }

  static std::int64_t bound_of(double bound) {
    return std::isfinite(bound) ? static_cast<std::int64_t>(std::ceil(bound)) : 0;
  }

  void describe(const SearchResult<SceneState>& found) {
    switch (found.reason) {
      case StopReason::solved:
        result_.status = Status::solved;
        result_.reason = fmt::format("the scene costs at most {} times the optimum", settings_.w);
        return;
      case StopReason::infeasible:
        result_.status = Status::infeasible;
        result_.reason = "no arrangement of all objects on this grid is free of collisions and monotone";
        for (std::size_t model = 0; model < problem_->models().size(); ++model)
          if (problem_->copies()[model] > 0 && candidates_.set.of_model(model).empty())
            result_.reason = no_pose(model);
        return;
      case StopReason::time:
      case StopReason::cancelled:
      case StopReason::max_expansions:
      case StopReason::memory:
        result_.status = Status::time_limit;
        result_.reason = fmt::format("the search was stopped by its limit ({}) before the bound was proven",
                                     name(found.reason));
        return;
    }
  }

  void finish() {
    std::vector<PlacedModel> placed;
    for (const CandidateId id : scene_)
      placed.push_back({candidates_.set[id].model, candidates_.set[id].pose});
    if (result_.search_cost) report_scene(*problem_, placed, result_);
    StageSeconds stages;
    for (const CandidateMaker& maker : makers_) stages += maker.seconds();
    Seconds& seconds = result_.stats.seconds;
    seconds.render = stages.render;
    seconds.refine = stages.refine;
    seconds.cost = stages.cost;
    seconds.total = watch_.seconds();
    result_.stats.threads = static_cast<int>(executor_.workers());
  }

  const Stopwatch watch_;
  const Settings& settings_;
  const Executor& executor_;
  const StopCondition& stop_;
  const std::function<void(const Progress&)>& on_progress_;
  std::unique_ptr<LocalizationProblem> problem_;
  std::vector<CandidateMaker> makers_;
  FixedCandidates candidates_;
  std::vector<CandidateId> scene_;
  Result result_;
};

}  // namespace

Result localize(const Scene& scene, const Settings& settings, const Executor& executor,
                const StopCondition& stop, const std::function<void(const Progress&)>& on_progress) {
  settings.check();
  const Stopwatch watch;
  try {
    return Localization(scene, settings, executor, stop, on_progress).run();
  } catch (const Interrupted&) {
    Result result;
    result.status = Status::time_limit;
    result.reason = "the time limit came while the observation was prepared";
    result.observed_points =
        static_cast<std::int64_t>(Observation(scene.camera, scene.depth, scene.mask).size());
    describe_guarantee(settings, result.guarantee);
    result.stats.threads = static_cast<int>(executor.workers());
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
