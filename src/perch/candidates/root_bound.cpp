#include "perch/candidates/root_bound.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perch {
namespace {

using Weight = Lagrangian::Weight;

constexpr std::size_t promising = 16;     // of each body
constexpr std::size_t near_priors = 8;    // for each: some may collide with what stands at another one
constexpr std::size_t most_valued = 256;  // in a step: what they show may rule out the others
constexpr int step_iterations = 40;       // of the dual
constexpr double worth_another = 0.95;    // of the gap to what is enough is left

std::vector<std::size_t> places(const std::vector<char>& chosen) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    if (chosen[i]) result.push_back(i);
  return result;
}

/// Chooses for a model the `number` of hypotheses with the smallest `rank` of those that are `wanted`.
template <typename Rank, typename Wanted>
void choose(const std::vector<FixedCandidates::Hypothesis>& open, std::size_t model, std::size_t number,
            const Rank& rank, const Wanted& wanted, std::vector<char>& chosen) {
  std::vector<std::pair<double, std::size_t>> own;
  for (std::size_t i = 0; i < open.size(); ++i)
    if (open[i].model == model) own.emplace_back(rank(i), i);
  std::sort(own.begin(), own.end());
  for (const auto& [rank_of_i, i] : own) {
    if (number == 0) break;
    if (!wanted(i)) continue;
    chosen[i] = 1;
    --number;
  }
}

}  // namespace

RootBound::RootBound(const LocalizationProblem& problem, FixedCandidates& candidates,
                     const Executor& executor)
    : problem_(problem), candidates_(candidates), executor_(executor), dual_(problem) {}

bool RootBound::value_near(const std::vector<PriorPose>& priors, const StopCondition& stop) {
  const auto& open = candidates_.open();
  std::vector<char> chosen(open.size(), 0);
  for (const PriorPose& prior : priors) {
    const ObjectModel& model = problem_.models()[prior.model];
    choose(
        open, prior.model, near_priors,
        [&](std::size_t i) { return pose_distance(model, open[i].pose, prior.pose); },
        [](std::size_t) { return true; }, chosen);
  }
  return candidates_.value(places(chosen), stop);
}

bool RootBound::value_promising(const std::vector<std::vector<std::int64_t>>& point_weights,
                                const std::vector<int>& wanted, const std::vector<CandidateId>& placed,
                                const StopCondition& stop) {
  const auto& open = candidates_.open();
  const CandidateSet& set = candidates_.set();
  const std::vector<Weight> most = candidates_.most_explained(point_weights, wanted);
  std::vector<char> chosen(open.size(), 0);
  for (std::size_t model = 0; model < problem_.models().size(); ++model) {
    if (wanted[problem_.kind_of(model)] == 0) continue;
    choose(
        open, model, promising,
        [&](std::size_t i) {
          return -static_cast<double>(most[i]) * (1.0 - static_cast<double>(open[i].misfit));
        },
        [&](std::size_t i) {
          return std::none_of(placed.begin(), placed.end(), [&](CandidateId id) {
            return !set[id].absent && problem_.collide(model, open[i].pose, set[id].model, set[id].pose);
          });
        },
        chosen);
  }
  return candidates_.value(places(chosen), stop);
}

/// A kind of which none of what is valued is in view may have hypotheses that are.
bool RootBound::value_unseen_kinds(const StopCondition& stop) {
  const auto& open = candidates_.open();
  for (std::size_t kind = 0; kind < problem_.kinds(); ++kind) {
    if (problem_.copies()[kind] == 0 || !candidates_.set().of_kind(kind).empty()) continue;
    std::vector<char> chosen(open.size(), 0);
    for (std::size_t i = 0; i < open.size(); ++i) chosen[i] = problem_.kind_of(open[i].model) == kind;
    if (!candidates_.value(places(chosen), stop)) return false;
  }
  return true;
}

std::optional<CandidateScene> RootBound::greedy_scene(const std::vector<CandidateId>& placed,
                                                      CandidateMaker& maker, const StopCondition& stop) {
  const CandidateSet& set = candidates_.set();
  return perch::greedy_scene(problem_, set, UnfinishedScene(problem_, set, placed), maker,
                             [&](const UnfinishedScene& scene, std::vector<int>& choice) {
                               const std::vector<std::int64_t> weights =
                                   weights_outside(scene.covered, problem_.observation().size());
                               return value_promising({weights}, choice, scene.placed, stop) &&
                                      (!scene.placed.empty() || value_unseen_kinds(stop));
                             });
}

bool RootBound::value_beside(const std::vector<CandidateId>& scene, const StopCondition& stop) {
  const CandidateSet& set = candidates_.set();
  const std::size_t points = problem_.observation().size();
  std::vector<std::vector<std::int64_t>> weights;
  for (std::size_t kind = 0; kind < problem_.kinds(); ++kind) {
    PointSet covered(points);
    for (const CandidateId id : scene)
      if (set.kind(id) != kind) covered.insert_all(set[id].explained);
    weights.push_back(weights_outside(covered, points));
  }
  return value_promising(weights, problem_.copies(), {}, stop);
}

std::vector<Weight> RootBound::most_worth() const {
  std::vector<Weight> most = candidates_.most_explained({dual_.point_weights()}, problem_.copies());
  const auto& open = candidates_.open();
  for (std::size_t i = 0; i < open.size(); ++i) most[i] += dual_.relief(kind_of(i), open[i].window);
  return most;
}

RootBound::Step RootBound::step(std::int64_t upper_bound, double enough, const StopCondition& stop) {
  dual_.add(candidates_.set(), executor_);
  for (;;) {
    const std::int64_t before = lower_bound_;
    dual_.ascend(step_iterations, upper_bound, 0.5 * (enough + static_cast<double>(upper_bound)), executor_,
                 stop);
    const std::vector<std::size_t> which = price(upper_bound, enough);
    if (static_cast<double>(lower_bound_) >= enough) return Step::complete;
    if (!which.empty()) return candidates_.value(which, stop) ? Step::valued : Step::interrupted;
    const auto gap = [&](std::int64_t bound) { return enough - static_cast<double>(bound); };
    if (gap(lower_bound_) > worth_another * gap(before)) return Step::complete;
    if (stop()) return Step::interrupted;
  }
}

/// Raises the lower bound to what the weights prove, and names the hypotheses to be valued.
std::vector<std::size_t> RootBound::price(std::int64_t upper_bound, double enough) {
  const std::vector<Weight> worth = most_worth();
  const auto& open = candidates_.open();

  // The bound if no open hypothesis were worth more than the best candidate, and as it is.
  Weight without = dual_.constant(), bound = without, copies = 0;
  std::vector<Weight> largest = dual_.largest();
  for (std::size_t i = 0; i < open.size(); ++i) largest[kind_of(i)] = std::max(largest[kind_of(i)], worth[i]);
  for (std::size_t kind = 0; kind < largest.size(); ++kind) {
    const Weight k = problem_.copies()[kind];
    without -= k * dual_.largest()[kind];
    bound -= k * largest[kind];
    copies += k;
  }
  lower_bound_ = std::clamp(Lagrangian::count(bound), lower_bound_, std::max(lower_bound_, upper_bound));
  if (static_cast<double>(lower_bound_) >= enough) return {};

  // How much less than the best of its kind a hypothesis must be worth to be of no use: less than nothing
  // where the bound has room to fall to what is enough; else so little that no scene with it is better.
  // Costs are whole: what exceeds the number below is enough.
  const auto number = static_cast<Weight>(std::ceil(std::min(enough, static_cast<double>(upper_bound))));
  const Weight aim = (number - 1) * Lagrangian::one + 1;
  const Weight margin =
      without >= aim ? -((without - aim) / copies) : (upper_bound - 1) * Lagrangian::one - without;
  const auto deficit = [&](std::size_t i) { return dual_.largest()[kind_of(i)] - worth[i]; };
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < open.size(); ++i)
    if (deficit(i) <= margin) which.push_back(i);
  std::stable_sort(which.begin(), which.end(),
                   [&](std::size_t a, std::size_t b) { return deficit(a) < deficit(b); });
  which.resize(std::min(which.size(), margin < 0 ? std::max(most_valued, which.size() / 2) : most_valued));
  std::sort(which.begin(), which.end());
  return which;
}

}  // namespace perch
