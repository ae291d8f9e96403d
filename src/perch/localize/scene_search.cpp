#include "perch/localize/scene_search.hpp"

#include <algorithm>
#include <cmath>

#include "perch/candidates/root_bound.hpp"
#include "perch/heuristics/heuristics.hpp"
#include "perch/search/branch_and_bound.hpp"
#include "perch/search/focal_mha.hpp"
#include "perch/tree/scene_branching.hpp"
#include "perch/tree/scene_tree.hpp"

namespace perch {
namespace {

constexpr int bound_iterations = 60;  // of the Lagrangian bound; most of what it gives comes in the first ten
constexpr int widening_rounds = 10;
constexpr std::size_t most_widened = 4000;  // candidates that are rendered once more to widen certain costs
constexpr int more_looks = 3;               // for candidates that fit in beside the others of the best scene
constexpr std::size_t most_handed_on = 8;   // good scenes that are handed on

std::int64_t whole(double bound) {
  return std::isfinite(bound) ? static_cast<std::int64_t>(std::ceil(bound)) : 0;
}

class SceneSearch {
 public:
  SceneSearch(const LocalizationProblem& problem, FixedCandidates& candidates,
              std::vector<CandidateMaker>& makers, const std::vector<PriorPose>& priors,
              const Settings& settings, const Executor& executor, const StopCondition& stop, ProgressLog& log)
      : problem_(problem),
        candidates_(candidates),
        set_(candidates.set()),
        makers_(makers),
        priors_(priors),
        settings_(settings),
        executor_(executor),
        stop_(stop),
        log_(log) {}

  SearchOutcome over_all() {
    log_.stage("first scenes");
    RootBound root(problem_, candidates_, executor_);
    if (!root.value_near(priors_, stop_)) return stopped(0);
    const auto start_from = [&](const std::vector<CandidateId>& placed) {
      if (auto scene = root.greedy_scene(placed, makers_.front(), stop_))
        outcome_.scenes.push_back(std::move(*scene));
    };
    start_from({});
    if (!priors_.empty()) start_from(nearest_to_priors(problem_, set_, priors_));
    if (stop_()) return stopped(0);
    sort_scenes();
    if (some_object_has_no_pose()) return std::move(outcome_);
    if (known()) {
      look_again(0);
    } else {
      outcome_.scenes = first_scenes(problem_, set_, makers_, executor_, stop_, priors_);
    }
    for (int look = 0; look < more_looks && known(); ++look) {
      const auto before = static_cast<CandidateId>(set_.size());
      if (!root.value_beside(outcome_.scenes.front().candidates, stop_)) return stopped(0);
      if (!look_again(before)) break;
    }
    log_.stage("bound");
    for (auto step = RootBound::Step::valued; step != RootBound::Step::complete;) {
      const auto before = static_cast<CandidateId>(set_.size());
      step = root.step(upper_bound(), enough(), stop_);
      report_bound(root.lower_bound());
      if (step == RootBound::Step::interrupted) return stopped(root.lower_bound());
      if (step != RootBound::Step::valued) continue;
      if (known())
        look_again(before);
      else
        outcome_.scenes = first_scenes(problem_, set_, makers_, executor_, stop_, priors_);
    }
    if (static_cast<double>(root.lower_bound()) >= enough()) {
      outcome_.lower_bound = root.lower_bound();
      outcome_.reason = StopReason::solved;
      if (outcome_.scenes.size() > most_handed_on) outcome_.scenes.resize(most_handed_on);
      return std::move(outcome_);
    }
    LagrangianBound bound = root.bound();
    improve(bound);
    log_.stage("search");
    SceneBranching branching(problem_, set_, makers_, executor_, bound, stop_);
    using Solution = SceneBranching::Solution;
    std::optional<Incumbent<Solution>> known;
    if (!outcome_.scenes.empty())
      known = Incumbent<Solution>{outcome_.scenes.front().candidates,
                                  static_cast<double>(outcome_.scenes.front().cost)};
    BranchAndBoundOptions options;
    options.w = settings_.stopping_factor();
    options.max_expansions = settings_.max_expansions;
    SearchObserver<Solution> observer;
    observer.on_incumbent = [&](const Incumbent<Solution>& found, const SearchProgress& p) {
      outcome_.scenes.push_back({found.state, static_cast<std::int64_t>(found.cost)});
      report(p);
    };
    observer.on_expansion = [&](const SearchProgress& p) { report(p); };
    take(branch_and_bound(branching, options, stop_, std::move(known), observer));
    outcome_.lower_bound = std::max(outcome_.lower_bound, root.lower_bound());
    return std::move(outcome_);
  }

  SearchOutcome over_tree() {
    log_.stage("first scenes");
    if (!candidates_.value_all(stop_)) return stopped(0);
    if (some_object_has_no_pose()) return std::move(outcome_);
    std::optional<Incumbent<SceneState>> first;
    {
      const SceneTree whole = SceneTree::fixed(problem_, set_, makers_, executor_, settings_.tree);
      outcome_.scenes = first_scenes(problem_, set_, makers_, executor_, stop_, priors_);
      std::erase_if(outcome_.scenes,
                    [&](const CandidateScene& scene) { return !whole.contains(scene.candidates); });
      if (!outcome_.scenes.empty())
        first = Incumbent<SceneState>{whole.state_of(outcome_.scenes.front().candidates),
                                      static_cast<double>(outcome_.scenes.front().cost)};
    }
    std::optional<ReducedCosts> reduced_costs;
    std::int64_t lower_bound = 0;
    if (first && settings_.bound == StateBound::lagrangian) {
      LagrangianBound bound(problem_, set_);
      improve(bound);
      set_.restrict_to(bound.kept());
      reduced_costs = bound.reduced_costs();
      lower_bound = bound.lower_bound();
    }
    SceneTree tree = SceneTree::fixed(problem_, set_, makers_, executor_, settings_.tree);
    if (settings_.bound == StateBound::none) tree.forget_cover_bound();
    if (reduced_costs) tree.use(*reduced_costs, lower_bound, static_cast<std::int64_t>(first->cost));
    focal_mha_over(tree, std::move(first));
    return std::move(outcome_);
  }

  SearchOutcome in_context(std::int64_t& hypotheses) {
    SceneTree tree = SceneTree::in_context(problem_, set_, makers_, executor_, settings_.tree);
    std::optional<Incumbent<SceneState>> first;
    if (!priors_.empty())
      if (const auto guided = tree.guided_by(priors_)) {
        first = Incumbent<SceneState>{*guided, static_cast<double>(guided->cost)};
        outcome_.scenes.push_back({guided->placed, guided->cost});
        log_.improved(guided->cost, 0);
      }
    focal_mha_over(tree, std::move(first));
    hypotheses += tree.hypotheses();
    return std::move(outcome_);
  }

 private:
  bool some_object_has_no_pose() const {
    for (std::size_t kind = 0; kind < problem_.kinds(); ++kind)
      if (problem_.copies()[kind] > 0 && set_.of_kind(kind).empty()) return true;
    return false;
  }

  void sort_scenes() {
    std::stable_sort(outcome_.scenes.begin(), outcome_.scenes.end(),
                     [](const CandidateScene& a, const CandidateScene& b) { return a.cost < b.cost; });
  }

  SearchOutcome stopped(std::int64_t lower_bound) {
    outcome_.lower_bound = lower_bound;
    outcome_.reason = stop_.cancelled() ? StopReason::cancelled : StopReason::time;
    return std::move(outcome_);
  }

  /// Tries candidates from a number on in the best scene. True where that made it better.
  bool look_again(CandidateId from) {
    CandidateScene scene = outcome_.scenes.front();
    const bool better = improve_scene(problem_, set_, makers_, executor_, stop_, scene, from);
    if (better) outcome_.scenes.insert(outcome_.scenes.begin(), std::move(scene));
    return better;
  }

  bool known() const { return !outcome_.scenes.empty(); }
  std::int64_t upper_bound() const { return known() ? outcome_.scenes.front().cost : no_cost; }
  /// The bound that proves the best scene known good enough.
  double enough() const { return static_cast<double>(upper_bound()) / settings_.stopping_factor(); }
  void report_bound(std::int64_t lower_bound) {
    log_.improved(known() ? std::optional(upper_bound()) : std::nullopt, lower_bound);
  }

  /// The bound at the root: improved, copies told apart and certain costs widened in turn, until it is good
  /// enough or none of these gives more.
  void improve(LagrangianBound& bound) {
    log_.stage("bound");
    const auto improve_weights = [&] {
      bound.improve(bound_iterations, upper_bound(), enough(), executor_, stop_);
      report_bound(bound.lower_bound());
    };
    improve_weights();
    for (int round = 0; round < widening_rounds; ++round) {
      const std::int64_t before = bound.lower_bound();
      const std::size_t kept = bound.kept_count();
      if (stop_() || static_cast<double>(before) >= enough() || kept > most_widened) break;
      if (known())
        bound.separate_copies(outcome_.scenes.front().candidates, bound_iterations, upper_bound(), executor_,
                              stop_);
      bound.widen_certain(makers_, executor_);
      improve_weights();
      if (bound.lower_bound() == before && bound.kept_count() == kept) break;
    }
  }

  void focal_mha_over(SceneTree& tree, std::optional<Incumbent<SceneState>> first) {
    log_.stage("search");
    Heuristics<SceneState> heuristics;
    heuristics.admissible = bound_heuristic;
    heuristics.inadmissible = {DepthHeuristic(problem_.object_count()), OverlapHeuristic(problem_, set_)};
    if (!priors_.empty()) heuristics.inadmissible.push_back(PriorHeuristic(problem_, set_, priors_));
    FocalMhaOptions options;
    options.w = settings_.w;
    options.anytime = settings_.anytime;
    options.max_expansions = settings_.max_expansions;
    SearchObserver<SceneState> observer;
    observer.on_incumbent = [&](const Incumbent<SceneState>& found, const SearchProgress& p) {
      outcome_.scenes.push_back({found.state.placed, static_cast<std::int64_t>(found.cost)});
      report(p);
    };
    observer.on_expansion = [&](const SearchProgress& p) { report(p); };
    take(focal_mha(tree, heuristics, options, stop_, std::move(first), observer));
  }

  void report(const SearchProgress& p) {
    log_.counts(p.generated, p.expanded);
    log_.improved(
        p.incumbent_cost ? std::optional(static_cast<std::int64_t>(*p.incumbent_cost)) : std::nullopt,
        whole(p.lower_bound));
  }

  template <typename State>
  void take(const SearchResult<State>& found) {
    outcome_.lower_bound = whole(found.lower_bound);
    outcome_.reason = found.reason;
    outcome_.generated = found.counters.generated;
    outcome_.expanded = found.counters.expanded;
    log_.counts(outcome_.generated, outcome_.expanded);
    // The incumbent is among the scenes: it was met first, or reported when it was found.
    sort_scenes();
    if (outcome_.scenes.size() > most_handed_on) outcome_.scenes.resize(most_handed_on);
    if (found.incumbent)
      log_.improved(static_cast<std::int64_t>(found.incumbent->cost), outcome_.lower_bound);
  }

  static constexpr std::int64_t no_cost = std::int64_t{1} << 40;

  const LocalizationProblem& problem_;
  FixedCandidates& candidates_;
  CandidateSet& set_;
  std::vector<CandidateMaker>& makers_;
  const std::vector<PriorPose>& priors_;
  const Settings& settings_;
  const Executor& executor_;
  const StopCondition& stop_;
  ProgressLog& log_;
  SearchOutcome outcome_;
};

}  // namespace

SearchOutcome search_fixed(const LocalizationProblem& problem, FixedCandidates& candidates,
                           std::vector<CandidateMaker>& makers, const std::vector<PriorPose>& priors,
                           const Settings& settings, const Executor& executor, const StopCondition& stop,
                           ProgressLog& log) {
  SceneSearch search(problem, candidates, makers, priors, settings, executor, stop, log);
  return settings.search_method() == SearchMethod::branch_and_bound ? search.over_all() : search.over_tree();
}

SearchOutcome search_in_context(const LocalizationProblem& problem, FixedCandidates& candidates,
                                std::vector<CandidateMaker>& makers, const std::vector<PriorPose>& priors,
                                const Settings& settings, const Executor& executor, const StopCondition& stop,
                                ProgressLog& log, std::int64_t& hypotheses) {
  return SceneSearch(problem, candidates, makers, priors, settings, executor, stop, log)
      .in_context(hypotheses);
}

}  // namespace perch
