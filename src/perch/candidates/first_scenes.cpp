#include "perch/candidates/first_scenes.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace perch {
namespace {

constexpr std::size_t most_starts = 8;      // greedy runs, each from another first object
constexpr std::size_t most_exchanges = 96;  // candidates valued exactly for one place of a scene
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
  void improve(CandidateScene& scene) const {
    for (int pass = 0; pass < most_passes; ++pass) {
      bool changed = false;
      for (std::size_t place = 0; place < scene.candidates.size() && !stop_(); ++place)
        changed = improve(scene, place) || changed;
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

  bool improve(CandidateScene& scene, std::size_t place) const {
    std::vector<CandidateId> others = scene.candidates;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(place));
    Composite composite = problem_.cost().empty();
    PointSet covered(problem_.observation().size());
    CandidateMaker& maker = makers_.front();
    for (const CandidateId id : others) {
      problem_.cost().add(composite, maker.patch(set_[id]), maker.scratch());
      covered.insert_all(set_[id].explained);
    }
    std::vector<Ranked> ranked;
    rank(set_[scene.candidates[place]].model, covered, ranked);
    const std::size_t kept = std::min(ranked.size(), most_exchanges);
    std::partial_sort(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(kept), ranked.end());
    ranked.resize(kept);

    std::vector<std::int64_t> costs(kept, -1);
    executor_.for_each(
        kept,
        [&](std::size_t i, std::size_t worker) {
          if (!fits(ranked[i].id, others)) return;
          CandidateMaker& own = makers_[worker];
          costs[i] =
              problem_.cost().counts_with(composite, own.patch(set_[ranked[i].id]), own.scratch()).total();
        },
        stop_);
    bool changed = false;
    for (std::size_t i = 0; i < kept; ++i)
      if (costs[i] >= 0 && costs[i] < scene.cost) {
        scene.cost = costs[i];
        scene.candidates[place] = ranked[i].id;
        changed = true;
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

}  // namespace perch
