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

  /// Greedily, beside what is `placed` already; an object of the model `first` comes first.
  std::optional<CandidateScene> greedy(std::optional<std::size_t> first,
                                       const std::vector<CandidateId>& placed = {}) const {
    return greedy_scene(problem_, set_, PartialScene(problem_, set_, placed), makers_.front(),
                        [&](const PartialScene& scene, std::vector<int>& choice) {
                          if (first && scene.placed.empty())
                            for (std::size_t model = 0; model < choice.size(); ++model)
                              if (model != *first) choice[model] = 0;
                          return !stop_();
                        });
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
    std::vector<std::pair<std::int64_t, CandidateId>> by_floor;
    for (const CandidateId id : set_.of_model(set_[scene.candidates[place]].model)) {
      if (id < from) continue;
      const std::int64_t floor = floor_of(set_[id]);
      if (floor < scene.cost && id != scene.candidates[place]) by_floor.emplace_back(floor, id);
    }
    std::sort(by_floor.begin(), by_floor.end());
    bool changed = false;
    std::vector<std::optional<std::int64_t>> costs;
    for (std::size_t i = 0; i < std::min(by_floor.size(), most_exchanges); i += exchange_batch) {
      if (by_floor[i].first >= scene.cost) break;
      const std::size_t size = std::min(exchange_batch, by_floor.size() - i);
      costs.assign(size, std::nullopt);
      executor_.for_each(
          size,
          [&](std::size_t k, std::size_t worker) {
            const CandidateId id = by_floor[i + k].second;
            if (fits(id, others)) costs[k] = makers_[worker].cost_with(composite, set_[id], scene.cost - 1);
          },
          stop_);
      for (std::size_t k = 0; k < size; ++k)
        if (costs[k] && *costs[k] < scene.cost) {
          scene.cost = *costs[k];
          scene.candidates[place] = by_floor[i + k].second;
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
