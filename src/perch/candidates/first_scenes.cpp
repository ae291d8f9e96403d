#include "perch/candidates/first_scenes.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "perch/candidates/candidate_floor.hpp"

namespace perch {
namespace {

constexpr std::size_t most_starts = 8;      // greedy runs, each from another first object
constexpr std::size_t most_exchanges = 96;  // candidates valued exactly for one place of a scene
constexpr std::size_t exchange_batch = 8;   // of these, valued at a time
constexpr int most_passes = 20;             // over the places of a scene; a handful is usual

class SceneBuilder {
 public:
  SceneBuilder(const LocalizationProblem& problem, const CandidateSet& set,
               std::vector<CandidateMaker>& makers, const Executor& executor, const StopCondition& stop)
      : problem_(problem), set_(set), makers_(makers), executor_(executor), stop_(stop) {}

  /// Greedily, beside what is `placed` already; an object of the kind `first` comes first.
  std::optional<CandidateScene> greedy(std::optional<std::size_t> first,
                                       const std::vector<CandidateId>& placed = {}) const {
    return greedy_scene(problem_, set_, UnfinishedScene(problem_, set_, placed), makers_.front(),
                        [&](const UnfinishedScene& scene, std::vector<int>& choice) {
                          if (first && scene.placed.empty())
                            for (std::size_t kind = 0; kind < choice.size(); ++kind)
                              if (kind != *first) choice[kind] = 0;
                          return !stop_();
                        });
  }

  /// Exchanges one candidate at a time for the best other one of its kind, as long as J falls.
  /// \param from candidates below this number have been tried in this very scene.
  void improve(CandidateScene& scene, CandidateId from = 0) const {
    for (int pass = 0; pass < most_passes; ++pass) {
      bool changed = false;
      std::vector<Place> ready;  // of this very scene, the last one first
      for (std::size_t place = 0; place < scene.candidates.size(); ++place) {
        if (ready.empty() && !prepare(scene, place, from, ready)) break;
        const Place here = std::move(ready.back());
        ready.pop_back();
        if (!exchange(here, scene, place)) continue;
        changed = true;
        from = 0;
        ready.clear();
      }
      if (!changed || stop_()) break;
    }
    std::sort(scene.candidates.begin(), scene.candidates.end());
  }

 private:
  bool fits(CandidateId id, const std::vector<CandidateId>& placed) const {
    return std::none_of(placed.begin(), placed.end(),
                        [&](CandidateId other) { return problem_.collide(set_[id], set_[other]); });
  }

  /// What a candidate is exchanged by: the others of the scene, and the candidates that may be cheaper, by
  /// ascending floor.
  struct Place {
    std::vector<CandidateId> others;
    Composite composite;
    std::vector<std::pair<std::int64_t, CandidateId>> by_floor;
  };

  /// Makes this place ready and, where there are more workers, some of those after it. False where the stop
  /// condition struck.
  bool prepare(const CandidateScene& scene, std::size_t place, CandidateId from,
               std::vector<Place>& ready) const {
    // What is made in vain must not be drawn.
    const bool drawn = std::all_of(scene.candidates.begin(), scene.candidates.end(), [&](CandidateId id) {
      return set_[id].absent || set_[id].drawn_elsewhere || !set_[id].patch.window.empty();
    });
    ready.resize(drawn ? std::min(scene.candidates.size() - place, executor_.workers()) : 1);
    return executor_.for_each(
        ready.size(),
        [&](std::size_t i, std::size_t worker) {
          ready[ready.size() - 1 - i] = make_place(scene, place + i, from, makers_[worker]);
        },
        stop_);
  }

  Place make_place(const CandidateScene& scene, std::size_t place, CandidateId from,
                   CandidateMaker& maker) const {
    Place made{scene.candidates, problem_.cost().empty(), {}};
    made.others.erase(made.others.begin() + static_cast<std::ptrdiff_t>(place));
    for (const CandidateId id : made.others) maker.add(made.composite, set_[id]);
    const CandidateFloor floor_of(problem_.cost(), made.composite);
    for (const CandidateId id : set_.of_kind(set_.kind(scene.candidates[place]))) {
      if (id < from || id == scene.candidates[place]) continue;
      const std::int64_t floor = floor_of(set_[id]);
      if (floor < scene.cost) made.by_floor.emplace_back(floor, id);
    }
    std::sort(made.by_floor.begin(), made.by_floor.end());
    return made;
  }

  /// Takes the best of the first candidates, until none of the rest can be cheaper. True where J fell.
  bool exchange(const Place& here, CandidateScene& scene, std::size_t place) const {
    bool changed = false;
    std::vector<std::optional<std::int64_t>> costs;
    for (std::size_t i = 0; i < std::min(here.by_floor.size(), most_exchanges); i += exchange_batch) {
      if (here.by_floor[i].first >= scene.cost) break;
      const std::size_t size = std::min(exchange_batch, here.by_floor.size() - i);
      costs.assign(size, std::nullopt);
      executor_.for_each(
          size,
          [&](std::size_t k, std::size_t worker) {
            const CandidateId id = here.by_floor[i + k].second;
            if (fits(id, here.others))
              costs[k] = makers_[worker].cost_with(here.composite, set_[id], scene.cost - 1);
          },
          stop_);
      for (std::size_t k = 0; k < size; ++k)
        if (costs[k] && *costs[k] < scene.cost) {
          scene.cost = *costs[k];
          scene.candidates[place] = here.by_floor[i + k].second;
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

std::vector<CandidateScene> first_scenes(const LocalizationProblem& problem, const CandidateSet& set,
                                         std::vector<CandidateMaker>& makers, const Executor& executor,
                                         const StopCondition& stop, const std::vector<PriorPose>& priors) {
  const SceneBuilder builder(problem, set, makers, executor, stop);
  std::vector<std::optional<std::size_t>> starts{std::nullopt};
  for (std::size_t kind = 0; kind < problem.kinds() && starts.size() < most_starts; ++kind)
    if (problem.copies()[kind] > 0) starts.push_back(kind);
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
