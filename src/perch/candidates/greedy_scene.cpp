#include "perch/candidates/greedy_scene.hpp"

#include <algorithm>
#include <utility>

namespace perch {

std::int64_t scene_cost(const LocalizationProblem& problem, const CandidateSet& set,
                        const std::vector<CandidateId>& candidates, CandidateMaker& maker) {
  Composite composite = problem.cost().empty();
  for (const CandidateId id : candidates) maker.add(composite, set[id]);
  return problem.cost().counts(composite).total();
}

UnfinishedScene::UnfinishedScene(const LocalizationProblem& problem, const CandidateSet& set,
                                 const std::vector<CandidateId>& candidates)
    : left(problem.copies()), covered(problem.observation().size()) {
  for (const CandidateId id : candidates) place(set, id);
}

void UnfinishedScene::place(const CandidateSet& set, CandidateId id) {
  placed.push_back(id);
  --left[set.kind(id)];
  covered.insert_all(set[id].explained);
}

std::optional<CandidateScene> greedy_scene(
    const LocalizationProblem& problem, const CandidateSet& set, UnfinishedScene scene, CandidateMaker& maker,
    const std::function<bool(const UnfinishedScene& scene, std::vector<int>& choice)>& before_choice) {
  while (scene.placed.size() < problem.object_count()) {
    std::vector<int> choice = scene.left;
    if (!before_choice(scene, choice)) return std::nullopt;
    const auto fits = [&](CandidateId id) {
      return std::none_of(scene.placed.begin(), scene.placed.end(),
                          [&](CandidateId other) { return problem.collide(set[id], set[other]); });
    };
    std::optional<std::pair<std::int64_t, CandidateId>> best;  // gain, and of equal ones the first
    for (std::size_t kind = 0; kind < choice.size(); ++kind)
      for (const CandidateId id : set.of_kind(kind)) {
        if (choice[kind] == 0) break;
        const std::int64_t gain =
            static_cast<std::int64_t>(set[id].explained.count_not_in(scene.covered)) - set[id].exposed;
        const bool better = !best || gain > best->first || (gain == best->first && id < best->second);
        if (better && fits(id)) best = {gain, id};
      }
    if (!best) return std::nullopt;
    scene.place(set, best->second);
  }
  std::sort(scene.placed.begin(), scene.placed.end());
  const std::int64_t cost = scene_cost(problem, set, scene.placed, maker);
  return CandidateScene{std::move(scene.placed), cost};
}

}  // namespace perch
