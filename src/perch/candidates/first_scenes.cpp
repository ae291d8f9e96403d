#include "perch/candidates/first_scenes.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "perch/candidates/candidate_floor.hpp"

namespace perch {
namespace {

constexpr std::size_t most_starts = 8;      // greedy runs, each from another first object
constexpr std::size_t most_exchanges = 96;  // candidates valued exactly for one place of a scene
constexpr std::size_t exchange_batch = 8;   // of these, valued at a time
constexpr int most_passes = 20;             // over the places of a scene; a handful is usual

struct Ranked {
  std::int64_t gain;
  CandidateId id;

  bool operator<(const Ranked& other) const {
    return std::tuple(-gain, id) < std::tuple(-other.gain, other.id);
  }
};

class SceneBuilder {
 public:
  SceneBuilder(const LocalizationProblem& problem, const CandidateSet& set,
               std::vector<CandidateMaker>& makers, const Executor& executor, const StopCondition& stop)
      : problem_(problem), set_(set), makers_(makers), executor_(executor), stop_(stop) {}

  /// Object by object, always the one that explains most more than it leaves to be explained, beside what is
  /// `placed` already; an object of the model `first` comes first.
  std::optional<CandidateScene> greedy(std::optional<std::size_t> first,
                                       std::vector<CandidateId> placed = {}) const {
    std::vector<int> left = problem_.copies();
    PointSet covered(problem_.observation().size());
    for (const CandidateId id : placed) {
      --left[set_[id].model];
      covered.insert_all(set_[id].explained);
    }
    while (placed.size() < problem_.object_count()) {
      std::vector<Ranked> ranked;
      for (std::size_t model = 0; model < left.size(); ++model)
        if (left[model] > 0 && (!placed.empty() || !first || *first == model)) rank(model, covered, ranked);
      std::sort(ranked.begin(), ranked.end());
      const auto chosen =
          std::find_if(ranked.begin(), ranked.end(), [&](const Ranked& r) { return fits(r.id, placed); });
      if (chosen == ranked.end() || stop_()) return std::nullopt;
      placed.push_back(chosen->id);
      covered.insert_all(set_[chosen->id].explained);
      --left[set_[chosen->id].model];
    }
    std::sort(placed.begin(), placed.end());
    return CandidateScene{placed, scene_cost(problem_, set_, placed, makers_.front())};
  }

  /// Exchanges one candidate at a time for the best other one of its model, as long as J falls.
  /// \param from candidates below this number have been tried in this very scene.
  void improve(CandidateScene& scene, CandidateId from = 0) const {
    for (int pass = 0; pass < most_passes; ++pass) {
      bool changed = false;
      for (std::size_t place = 0; place < scene.candidates.size() && !stop_(); ++place)
        if (improve(scene, place, from)) {
          changed = true;
          from = 0;
        }
      if (!changed || stop_()) break;
    }
    std::sort(scene.candidates.begin(), scene.candidates.end());
  }

 private:
  void rank(std::size_t model, const PointSet& covered, std::vector<Ranked>& ranked) const {
    for (const CandidateId id : set_.of_model(model))
      ranked.push_back(
          {static_cast<std::int64_t>(set_[id].explained.count_not_in(covered)) - set_[id].exposed, id});
  }

  bool fits(CandidateId id, const std::vector<CandidateId>& placed) const {
    return std::none_of(placed.begin(), placed.end(),
                        [&](CandidateId other) { return problem_.collide(set_[id], set_[other]); });
  }

  bool improve(CandidateScene& scene, std::size_t place, CandidateId from) const {
    std::vector<CandidateId> others = scene.candidates;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(place));
    Composite composite = problem_.cost().empty();
    CandidateMaker& maker = makers_.front();
    for (const CandidateId id : others)
      problem_.cost().add(composite, maker.patch(set_[id]), maker.scratch());

    // By ascending floor, until none of the rest can be cheaper.
    const CandidateFloor floor_of(problem_.cost(), composite);
    std::vector<Ranked> ranked;
    for (const CandidateId id : set_.of_model(set_[scene.candidates[place]].model)) {
      if (id < from) continue;
      const std::int64_t floor = floor_of(set_[id]);
      if (floor < scene.cost && id != scene.candidates[place]) ranked.push_back({-floor, id});
    }
    std::sort(ranked.begin(), ranked.end());
    bool changed = false;
    std::vector<std::optional<std::int64_t>> costs;
    for (std::size_t i = 0; i < std::min(ranked.size(), most_exchanges); i += exchange_batch) {
      if (-ranked[i].gain >= scene.cost) break;
      const std::size_t size = std::min(exchange_batch, ranked.size() - i);
      costs.assign(size, std::nullopt);
      executor_.for_each(
          size,
          [&](std::size_t k, std::size_t worker) {
            const CandidateId id = ranked[i + k].id;
            if (fits(id, others)) costs[k] = makers_[worker].cost_with(composite, set_[id], scene.cost - 1);
          },
          stop_);
      for (std::size_t k = 0; k < size; ++k)
        if (costs[k] && *costs[k] < scene.cost) {
          scene.cost = *costs[k];
          scene.candidates[place] = ranked[i + k].id;
          changed = true;
        }
    }
    return changed;
  }

  const LocalizationProblem& problem_;
  const CandidateSet& set_;
  std::vector<CandidateMaker>& makers_;
  const Executor& executor_;
  const StopCondition& stop_;
};

}  // namespace

std::int64_t scene_cost(const LocalizationProblem& problem, const CandidateSet& set,
                        const std::vector<CandidateId>& candidates, CandidateMaker& maker) {
  Composite composite = problem.cost().empty();
  for (const CandidateId id : candidates)
    problem.cost().add(composite, maker.patch(set[id]), maker.scratch());
  return problem.cost().counts(composite).total();
}

std::vector<CandidateScene> first_scenes(const LocalizationProblem& problem, const CandidateSet& set,
                                         std::vector<CandidateMaker>& makers, const Executor& executor,
                                         const StopCondition& stop, const std::vector<PriorPose>& priors) {
  const SceneBuilder builder(problem, set, makers, executor, stop);
  std::vector<std::optional<std::size_t>> starts{std::nullopt};
  for (std::size_t model = 0; model < problem.copies().size() && starts.size() < most_starts; ++model)
    if (problem.copies()[model] > 0) starts.push_back(model);
  std::vector<CandidateScene> scenes;
  std::vector<std::vector<CandidateId>> seen;
  const auto start = [&](std::optional<CandidateScene> scene) {
    if (!scene || std::find(seen.begin(), seen.end(), scene->candidates) != seen.end()) return;
    seen.push_back(scene->candidates);
    builder.improve(*scene);
    scenes.push_back(std::move(*scene));
  };
  if (!priors.empty()) start(builder.greedy(std::nullopt, nearest_to_priors(problem, set, priors)));
  for (const auto& first : starts) {
    if (stop()) break;
    start(builder.greedy(first));
  }
  std::sort(scenes.begin(), scenes.end(), [](const CandidateScene& a, const CandidateScene& b) {
    return std::tie(a.cost, a.candidates) < std::tie(b.cost, b.candidates);
  });
  scenes.erase(std::unique(scenes.begin(), scenes.end(),
                           [](const CandidateScene& a, const CandidateScene& b) {
                             return a.candidates == b.candidates;
                           }),
               scenes.end());
  return scenes;
}

bool improve_scene(const LocalizationProblem& problem, const CandidateSet& set,
                   std::vector<CandidateMaker>& makers, const Executor& executor, const StopCondition& stop,
                   CandidateScene& scene, CandidateId from) {
  const std::int64_t before = scene.cost;
  SceneBuilder(problem, set, makers, executor, stop).improve(scene, from);
  return scene.cost < before;
}

}  // namespace perch
