#include "perch/localize/polish.hpp"

#include <algorithm>
#include <cmath>

#include "perch/localize/pose_descent.hpp"

namespace perch {
namespace {

constexpr double near_optimal = 1.5;  // times the cheapest start: a polish takes off a third of J at most

class Polisher {
 public:
  Polisher(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers, const Executor& executor,
           const ArrangedScene& start, const PolishSettings& settings, const StopCondition& stop,
           std::size_t worker)
      : settings_(settings),
        stop_(stop),
        drawings_(makers, executor),
        trials_(problem, makers, executor, stop, worker),
        descent_(trials_, settings.descent,
                 static_cast<std::int64_t>(settings.trials) * static_cast<std::int64_t>(start.placed.size())),
        scene_(start),
        looked_at_(start.placed.size(), never),
        moved_at_(start.placed.size(), never) {}

  ArrangedScene run() {
    for (int round = 0; round < settings_.rounds; ++round)
      for (std::size_t place = 0; place < scene_.placed.size(); ++place) {
        if (!worth_a_look(place)) continue;
        move(place, round == 0);
        if (!descent_.going()) return scene_;
      }
    return scene_;
  }

 private:
  static constexpr int never = -1;

  /// False where no other object has moved since this one was last moved to its best.
  bool worth_a_look(std::size_t place) const {
    if (looked_at_[place] == never) return true;
    for (std::size_t other = 0; other < moved_at_.size(); ++other)
      if (other != place && moved_at_[other] > looked_at_[place]) return true;
    return false;
  }

  void move(std::size_t place, bool turn) {
    Pose& pose = scene_.placed[place].pose;
    if (!drawings_.draw(scene_.placed, stop_)) return;
    trials_.take_out(scene_.placed, place, drawings_);
    const auto here = trials_.run_one(pose);
    if (!here) return;
    const TrialResult best = descent_.run(*here, turn);
    ++clock_;
    looked_at_[place] = clock_;
    if (!(best.pose == pose)) moved_at_[place] = clock_;
    pose = best.pose;
    scene_.cost = best.cost;
  }

  const PolishSettings& settings_;
  const StopCondition& stop_;
  SceneDrawings drawings_;
  ObjectTrials trials_;
  PoseDescent descent_;
  ArrangedScene scene_;
  std::vector<int> looked_at_, moved_at_;  ///< by clock_
  int clock_ = 0;
};

/// True where every object of one scene lies within reach of one of the other's (metres; of a turn: at the
/// model's radius): a polish takes both to the same place, or nearly.
bool alike(const LocalizationProblem& problem, const ArrangedScene& a, const ArrangedScene& b, double reach) {
  return a.placed.size() == b.placed.size() &&
         std::all_of(a.placed.begin(), a.placed.end(), [&](const PlacedModel& object) {
           const ObjectModel& model = problem.models()[object.model];
           return std::any_of(b.placed.begin(), b.placed.end(), [&](const PlacedModel& other) {
             return other.model == object.model &&
                    std::hypot(other.pose.x - object.pose.x, other.pose.y - object.pose.y) <= reach &&
                    model.radius() * model.symmetry().yaw_difference(other.pose.yaw, object.pose.yaw) <=
                        reach;
           });
         });
}

}  // namespace

ArrangedScene polish(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers,
                     const Executor& executor, const ArrangedScene& start, const PolishSettings& settings,
                     const StopCondition& stop, std::size_t worker) {
  ArrangedScene polished = Polisher(problem, makers, executor, start, settings, stop, worker).run();
  // Moves that keep J and lie nearer to the points alone don't make another scene of it.
  return polished.cost < start.cost ? polished : start;
}

ArrangedScene polish_best(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers,
                          const Executor& executor, const std::vector<ArrangedScene>& starts,
                          const PolishSettings& settings, const StopCondition& stop) {
  if (settings.rounds == 0) return starts.front();
  const auto limit = static_cast<std::int64_t>(near_optimal * static_cast<double>(starts.front().cost));
  const double reach = 2.0 * settings.descent.largest_step;
  std::vector<ArrangedScene> scenes;
  for (const ArrangedScene& start : starts) {
    if (scenes.size() == static_cast<std::size_t>(settings.scenes) || start.cost > limit) break;
    if (std::none_of(scenes.begin(), scenes.end(),
                     [&](const ArrangedScene& other) { return alike(problem, start, other, reach); }))
      scenes.push_back(start);
  }
  // Side by side: within one, few trials can be run at a time.
  executor.for_each(
      scenes.size(),
      [&](std::size_t i, std::size_t worker) {
        scenes[i] = polish(problem, makers, executor, scenes[i], settings, stop, worker);
      },
      stop);
  ArrangedScene best = starts.front();
  for (const ArrangedScene& polished : scenes)
    if (polished.cost < best.cost) best = polished;
  return best;
}

}  // namespace perch
