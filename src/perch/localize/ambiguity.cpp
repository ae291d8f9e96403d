#include "perch/localize/ambiguity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "perch/candidates/candidate_floor.hpp"
#include "perch/localize/polish.hpp"
#include "perch/localize/pose_descent.hpp"
#include "perch/localize/report.hpp"

namespace perch {
namespace {

constexpr std::size_t batch_size = 8;  // candidates valued at a time
constexpr int exchanges = 3;           // answers that may be replaced by their runner-up
constexpr double close_call = 10.0;    // increases above this many roots of the support need no descent
constexpr double significant = 0.5;    // an increase of this many roots of the support tells two poses apart
constexpr double least_evidence = 100.0;  // points: fewer can lie anywhere by chance

/// The poses that count as the answer's own: of the same body alone.
class Neighbourhood {
 public:
  Neighbourhood(const TrialResult& centre, const Symmetry& symmetry, const AmbiguitySettings& settings)
      : body_(centre.model), centre_(centre.pose), symmetry_(symmetry), settings_(settings) {}

  bool contains(std::size_t body, const Pose& pose) const {
    return body == body_ && std::hypot(pose.x - centre_.x, pose.y - centre_.y) <= settings_.distance &&
           symmetry_.yaw_difference(pose.yaw, centre_.yaw) <= settings_.yaw;
  }

  /// Poses just outside: shifted in eight directions, turned both ways.
  void append_ring(std::vector<Trial>& trials) const {
    constexpr double outside = 1.0 + 1e-6;
    for (int k = 0; k < 8; ++k) {
      const double angle = k * std::numbers::pi / 4.0, shift = outside * settings_.distance;
      trials.push_back(
          {{centre_.x + shift * std::cos(angle), centre_.y + shift * std::sin(angle), centre_.yaw}});
    }
    if (!symmetry_.is_continuous() && outside * settings_.yaw < 0.5 * symmetry_.period())
      for (const double turn : {outside * settings_.yaw, -outside * settings_.yaw})
        trials.push_back({{centre_.x, centre_.y, centre_.yaw + turn}});
  }

 private:
  std::size_t body_;
  Pose centre_;
  const Symmetry& symmetry_;
  const AmbiguitySettings& settings_;
};

/// Judges one object of a scene.
class Judge {
 public:
  Judge(const LocalizationProblem& problem, const FixedCandidates& candidates,
        std::vector<CandidateMaker>& makers, const Executor& executor, const AmbiguitySettings& settings,
        const DescentSettings& descent, const StopCondition& stop, std::size_t worker)
      : problem_(problem),
        candidates_(candidates),
        settings_(settings),
        descent_(descent),
        trials_(problem, makers, executor, stop, worker),
        left_(settings.trials) {}

  /// Empty where the stop condition struck.
  std::optional<ObjectJudgement> judge(const ArrangedScene& scene, std::size_t place,
                                       const SceneDrawings& drawings) {
    trials_.take_out(scene.placed, place, drawings);
    ObjectJudgement judgement;
    const auto answer = trials_.run_one(scene.placed[place].pose);
    if (!answer) return judgement;  // none of it is in view
    judgement.visible = trials_.visible_points(drawings[place]);
    judgement.support = trials_.cost_without() - answer->cost;
    // Where points of I cost nothing, it is the object's own points that speak for it.
    if (!problem_.cost().charges_points()) judgement.support += trials_.explained_points(drawings[place]);
    close_limit_ =
        answer->cost +
        static_cast<std::int64_t>(
            close_call * std::sqrt(static_cast<double>(std::max<std::int64_t>(1, judgement.support))));
    const Neighbourhood own(*answer, trials_.model().symmetry(), settings_);
    if (!find_others(own) || !move_downhill(own)) return std::nullopt;

    std::optional<std::int64_t> increase;
    if (!found_.empty()) {
      increase = found_.front().cost - answer->cost;
      judgement.runner_up =
          RunnerUp{found_.front().pose, *increase, rest_pose(problem_, found_.front().model)};
    }
    judgement.confidence = confidence(judgement.visible, judgement.support, increase);
    const TrialOrder order(trials_, *answer, descent_);
    for (const TrialResult& other : found_)
      if (!better_ && other.cost < answer->cost && order.improves(other, *answer)) better_ = other;
    return judgement;
  }

  /// A pose that the rule of the polish prefers to the one judged.
  const std::optional<TrialResult>& better() const { return better_; }

 private:
  /// Values the poses around the answer's neighbourhood, then candidates by ascending floor until none of the
  /// rest can be cheaper than the best. False where the stop condition struck.
  bool find_others(const Neighbourhood& own) {
    batch_.clear();
    own.append_ring(batch_);
    if (!run_batch(own)) return false;

    const CandidateFloor floor_of(problem_.cost(), trials_.others());
    struct Other {
      std::int64_t floor;
      std::size_t body;
      Pose pose;
    };
    std::vector<Other> order;
    const std::size_t kind = problem_.kind_of(trials_.model_number());
    const CandidateSet& set = candidates_.set();
    for (CandidateId id = 0; id < set.size(); ++id)
      if (set.kind(id) == kind && !set[id].absent && !own.contains(set[id].model, set[id].pose))
        order.push_back({floor_of(set[id]), set[id].model, set[id].pose});
    const auto& open = candidates_.open();
    std::vector<int> wanted(problem_.kinds(), 0);
    wanted[kind] = 1;
    const auto explained = candidates_.most_explained(
        {weights_outside(trials_.others().observed, problem_.observation().size())}, wanted);
    for (std::size_t i = 0; i < open.size(); ++i)
      if (problem_.kind_of(open[i].model) == kind && !own.contains(open[i].model, open[i].pose))
        order.push_back({floor_of(explained[i], open[i].window), open[i].model, open[i].pose});
    std::stable_sort(order.begin(), order.end(),
                     [](const Other& a, const Other& b) { return a.floor < b.floor; });
    for (std::size_t i = 0; i < order.size() && left_ > 0;) {
      batch_.clear();
      for (; i < order.size() && batch_.size() < batch_size; ++i)
        if (found_.empty() || order[i].floor < found_.front().cost)
          batch_.push_back({order[i].pose, false, order[i].body});
      if (batch_.empty()) break;
      if (!run_batch(own)) return false;
    }
    return true;
  }

  /// Moves the best few of those found, each another pose than the others, as far down as they get outside
  /// the answer's neighbourhood. False where the stop condition struck.
  bool move_downhill(const Neighbourhood& own) {
    std::vector<TrialResult> starts;
    for (const TrialResult& other : found_) {
      if (starts.size() == static_cast<std::size_t>(settings_.descents) || other.cost > close_limit_) break;
      if (std::none_of(starts.begin(), starts.end(), [&](const TrialResult& start) {
            return Neighbourhood(start, trials_.model(start.model).symmetry(), settings_)
                .contains(other.model, other.pose);
          }))
        starts.push_back(other);
    }
    PoseDescent descent(trials_, descent_, left_);
    for (const TrialResult& start : starts) {
      found_.push_back(
          descent.run(start, false, [&](const Pose& pose) { return !own.contains(start.model, pose); }));
      if (trials_.stopped()) return false;
    }
    sort_found();
    return true;
  }

  /// What costs more than the best found and is no close call is not needed.
  bool run_batch(const Neighbourhood& own) {
    left_ -= static_cast<std::int64_t>(batch_.size());
    const std::int64_t most = found_.empty() ? std::numeric_limits<std::int64_t>::max()
                                             : std::max(close_limit_, found_.front().cost);
    if (!trials_.run(batch_, most, answers_)) return false;
    for (const auto& answer : answers_)
      if (answer && !own.contains(answer->model, answer->pose)) found_.push_back(*answer);
    sort_found();
    return true;
  }

  void sort_found() {
    std::stable_sort(found_.begin(), found_.end(),
                     [](const TrialResult& a, const TrialResult& b) { return a.cost < b.cost; });
  }

  const LocalizationProblem& problem_;
  const FixedCandidates& candidates_;
  const AmbiguitySettings& settings_;
  const DescentSettings& descent_;
  ObjectTrials trials_;
  std::int64_t left_;             ///< trials
  std::int64_t close_limit_ = 0;  ///< what costs more needs no descent
  std::vector<Trial> batch_;
  std::vector<std::optional<TrialResult>> answers_;
  std::vector<TrialResult> found_;  ///< other poses, cheapest first
  std::optional<TrialResult> better_;
};

}  // namespace

double confidence(std::int64_t visible, std::int64_t support, std::optional<std::int64_t> increase) {
  if (support <= 0) return 0.0;
  const double s = static_cast<double>(support);
  const double supported = std::min(1.0, s / (0.5 * (static_cast<double>(visible) + least_evidence)));
  if (!increase) return supported;
  const double margin = static_cast<double>(*increase) / std::sqrt(s);
  return supported * std::max(0.0, 1.0 - std::exp(-margin / significant));
}

JudgedScene judge(const LocalizationProblem& problem, const FixedCandidates& candidates,
                  std::vector<CandidateMaker>& makers, const Executor& executor, ArrangedScene scene,
                  const AmbiguitySettings& settings, const PolishSettings& polish_settings,
                  const StopCondition& stop) {
  JudgedScene judged{std::move(scene), {}};
  if (settings.trials == 0) return judged;
  struct Outcome {
    std::optional<ObjectJudgement> judgement;
    std::optional<TrialResult> better;
  };
  SceneDrawings drawings(makers, executor);
  for (int left = polish_settings.rounds > 0 ? exchanges : 0;; --left) {
    std::vector<Outcome> outcomes(judged.scene.placed.size());
    const bool complete = drawings.draw(judged.scene.placed, stop) &&
                          executor.for_each(
                              outcomes.size(),
                              [&](std::size_t place, std::size_t worker) {
                                Judge judge_object(problem, candidates, makers, executor, settings,
                                                   polish_settings.descent, stop, worker);
                                outcomes[place].judgement = judge_object.judge(judged.scene, place, drawings);
                                outcomes[place].better = judge_object.better();
                              },
                              stop);
    if (!complete || std::any_of(outcomes.begin(), outcomes.end(),
                                 [](const Outcome& outcome) { return !outcome.judgement; }))
      return judged;
    const auto replaced = std::find_if(outcomes.begin(), outcomes.end(),
                                       [](const Outcome& outcome) { return outcome.better.has_value(); });
    if (left == 0 || replaced == outcomes.end()) {
      for (const Outcome& outcome : outcomes) judged.objects.push_back(*outcome.judgement);
      return judged;
    }
    const auto place = static_cast<std::size_t>(replaced - outcomes.begin());
    judged.scene.placed[place] = {replaced->better->model, replaced->better->pose};
    judged.scene.cost = replaced->better->cost;
    judged.scene = polish(problem, makers, executor, judged.scene, polish_settings, stop);
  }
}

}  // namespace perch
