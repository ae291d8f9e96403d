#include "perch/tree/scene_branching.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace perch {
namespace {

bool cheaper(const OpenSlot::Choice& a, const OpenSlot::Choice& b) {
  return std::tie(a.reduced_cost, a.id) < std::tie(b.reduced_cost, b.id);
}

int open_copies(const std::vector<OpenSlot>& slots) {
  int sum = 0;
  for (const OpenSlot& slot : slots) sum += slot.copies;
  return sum;
}

Incumbent<std::vector<CandidateId>> scene_of(std::vector<CandidateId> placed, std::int64_t cost) {
  std::sort(placed.begin(), placed.end());
  return {std::move(placed), static_cast<double>(cost)};
}

}  // namespace

SceneBranching::SceneBranching(const LocalizationProblem& problem, CandidateSet& set,
                               std::vector<CandidateMaker>& makers, const Executor& executor,
                               const LagrangianBound& bound, const StopCondition& stop)
    : problem_(problem), set_(set), makers_(makers), executor_(executor), bound_(bound.lower_bound()) {
  point_weights_ = bound.point_weights();
  const ReducedCosts reduced = bound.reduced_costs();
  auto family = std::make_shared<Family>();
  family->base = reduced.base();
  for (const int copies : bound.copies()) family->slots.push_back({copies, family->slots.size(), {}});
  const std::vector<char> kept = bound.kept();
  for (CandidateId id = 0; id < kept.size(); ++id)
    if (kept[id]) family->slots[bound.slot(id)].choices.push_back({id, reduced.reduced_cost(id)});
  std::erase_if(family->slots, [](const OpenSlot& slot) { return slot.copies == 0; });
  for (OpenSlot& slot : family->slots) std::sort(slot.choices.begin(), slot.choices.end(), cheaper);
  gains_.resize(bound.copies().size());
  root_ = std::move(family);
  keep_patches(kept, set, stop);
}

/// Every node looks at what its choices render.
void SceneBranching::keep_patches(const std::vector<char>& kept, CandidateSet& set,
                                  const StopCondition& stop) const {
  constexpr std::size_t most_bytes = 256U << 20U;
  std::vector<CandidateId> ids;
  std::size_t bytes = 0;
  for (CandidateId id = 0; id < kept.size(); ++id) {
    const Candidate& candidate = set[id];
    if (!kept[id] || candidate.absent || !candidate.patch.window.empty()) continue;
    bytes += static_cast<std::size_t>(candidate.window.width()) *
             static_cast<std::size_t>(candidate.window.height()) * sizeof(float);
    if (bytes > most_bytes) break;
    ids.push_back(id);
  }
  executor_.for_each(
      ids.size(),
      [&](std::size_t i, std::size_t worker) { set[ids[i]].patch = makers_[worker].patch(set[ids[i]]); },
      stop);
}

std::vector<SceneBranching::Answer> SceneBranching::branch(const std::vector<Node>& nodes, double upper_bound,
                                                           const StopCondition& stop) {
  // Costs are whole: what costs less than the upper bound costs at most one less.
  const std::int64_t limit =
      upper_bound < 1e12 ? static_cast<std::int64_t>(upper_bound) : std::int64_t{1} << 40;
  std::vector<Answer> answers(nodes.size());
  std::vector<std::int64_t> bounds(nodes.size(), 0);
  for (Answer& answer : answers) answer.complete = false;
  if (nodes.front().is_root) look_ahead(limit, stop);
  executor_.for_each(
      nodes.size(),
      [&](std::size_t i, std::size_t worker) {
        bounds[i] = work(nodes[i], limit, makers_[worker], stop, answers[i]);
      },
      stop);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (answers[i].complete) learn(nodes[i], std::min(bounds[i], limit));
  return answers;
}

void SceneBranching::learn(const Node& node, std::int64_t bound) {
  if (node.is_root) return;
  Gain& gain = gains_[node.family->slots[node.family->branching_slot].origin];
  gain.sum += static_cast<double>(std::max<std::int64_t>(0, bound - node.bound));
  ++gain.times;
}

/// Places each object of the root in turn at its most promising candidates, to see which raises the bound
/// whatever it is.
void SceneBranching::look_ahead(std::int64_t upper_bound, const StopCondition& stop) {
  constexpr std::size_t most_tried = 4;
  std::vector<Node> nodes;
  for (std::size_t s = 0; s < root_->slots.size(); ++s) {
    auto family = std::make_shared<Family>(*root_);
    family->branching_slot = s;
    for (std::size_t i = 0; i < std::min(most_tried, root_->slots[s].choices.size()); ++i)
      nodes.push_back({family, i, false, bound_});
  }
  std::vector<std::int64_t> bounds(nodes.size(), bound_);
  const bool complete = executor_.for_each(
      nodes.size(),
      [&](std::size_t i, std::size_t worker) {
        Answer answer;
        bounds[i] = work(nodes[i], upper_bound, makers_[worker], stop, answer);
      },
      stop);
  if (!complete) return;
  for (std::size_t i = 0; i < nodes.size();) {
    std::size_t least = i;
    const auto& family = nodes[i].family;
    for (; i < nodes.size() && nodes[i].family == family; ++i)
      if (bounds[i] < bounds[least]) least = i;
    learn(nodes[least], std::min(bounds[least], upper_bound));
  }
  root_->branching_slot = slot_to_branch(root_->slots);
}

/// The object whose placing raises the bound most. The root of the number of its children counts against it:
/// of the shares tried, it left the fewest nodes.
std::size_t SceneBranching::slot_to_branch(const std::vector<OpenSlot>& slots) const {
  std::size_t best = 0;
  double best_score = -1.0;
  for (std::size_t s = 0; s < slots.size(); ++s) {
    const double score =
        (gains_[slots[s].origin].mean() + 1e-3) / std::sqrt(static_cast<double>(slots[s].choices.size()));
    if (score <= best_score) continue;
    best_score = score;
    best = s;
  }
  return best;
}

std::int64_t SceneBranching::work(const Node& node, std::int64_t upper_bound, CandidateMaker& maker,
                                  const StopCondition& stop, Answer& answer) const {
  if (node.is_root) {
    branch_family(node.family, bound_, upper_bound, answer);
    return bound_;
  }
  const Family& parent = *node.family;
  auto family = std::make_shared<Family>();
  family->placed = parent.placed;
  family->placed.push_back(parent.slots[parent.branching_slot].choices[node.choice].id);
  std::vector<OpenSlot> slots = slots_beside(node, upper_bound);
  answer.complete = true;
  if (std::any_of(slots.begin(), slots.end(), [](const OpenSlot& slot) { return slot.choices.empty(); }))
    return upper_bound;
  Composite composite = problem_.cost().empty();
  for (const CandidateId id : family->placed) maker.add(composite, set_[id]);
  if (open_copies(slots) < 2) {
    complete(composite, *family, slots, upper_bound, maker, stop, answer);
    return upper_bound;
  }
  PartialBound partial =
      bound_partial_scene(problem_, set_, composite, slots, point_weights_, upper_bound, maker, stop);
  answer.complete = partial.complete;
  if (!partial.complete || partial.lower_bound >= upper_bound) return partial.lower_bound;
  try_scene(std::move(composite), family->placed, partial.best, upper_bound, maker, answer);
  family->base = partial.base;
  family->slots = std::move(partial.slots);
  family->branching_slot = slot_to_branch(family->slots);
  branch_family(family, std::max(node.bound, partial.lower_bound), upper_bound, answer);
  return partial.lower_bound;
}

void SceneBranching::branch_family(const std::shared_ptr<const Family>& family, std::int64_t lower_bound,
                                   std::int64_t upper_bound, Answer& answer) const {
  answer.complete = true;
  const OpenSlot& slot = family->slots[family->branching_slot];
  const auto& choices = slot.choices;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    // The other copies come after it in the list, so each adds no less.
    const std::int64_t bound =
        std::max(lower_bound, Lagrangian::count(family->base + slot.copies * choices[i].reduced_cost));
    if (bound >= upper_bound) break;  // and so are all after it
    answer.children.push_back({family, i, false, bound});
  }
}

std::vector<OpenSlot> SceneBranching::slots_beside(const Node& node, std::int64_t upper_bound) const {
  const Family& family = *node.family;
  const OpenSlot::Choice& taken = family.slots[family.branching_slot].choices[node.choice];
  std::vector<OpenSlot> slots;
  for (std::size_t s = 0; s < family.slots.size(); ++s) {
    const bool own = s == family.branching_slot;
    OpenSlot slot{family.slots[s].copies - static_cast<int>(own), family.slots[s].origin, {}};
    if (slot.copies == 0) continue;
    const auto& choices = family.slots[s].choices;
    for (std::size_t i = own ? node.choice : 0; i < choices.size(); ++i) {
      if (Lagrangian::count(family.base + taken.reduced_cost + choices[i].reduced_cost) >= upper_bound) break;
      if (!problem_.collide(set_[taken.id], set_[choices[i].id])) slot.choices.push_back(choices[i]);
    }
    slots.push_back(std::move(slot));
  }
  return slots;
}

/// At most one object is left: every choice is valued exactly.
void SceneBranching::complete(const Composite& composite, const Family& family,
                              const std::vector<OpenSlot>& last, std::int64_t upper_bound,
                              CandidateMaker& maker, const StopCondition& stop, Answer& answer) const {
  if (last.empty()) {
    const std::int64_t cost = problem_.cost().counts(composite).total();
    if (cost < upper_bound) answer.found = scene_of(family.placed, cost);
    return;
  }
  std::int64_t best = upper_bound;
  for (const OpenSlot::Choice& choice : last.front().choices) {
    if (stop()) {
      answer.complete = false;
      return;
    }
    const auto cost = maker.cost_with(composite, set_[choice.id], best - 1);
    if (!cost) continue;
    best = *cost;
    std::vector<CandidateId> placed = family.placed;
    placed.push_back(choice.id);
    answer.found = scene_of(std::move(placed), best);
  }
}

/// The scene that the weights favour is often a good one.
void SceneBranching::try_scene(Composite composite, std::vector<CandidateId> placed,
                               const std::vector<CandidateId>& more, std::int64_t upper_bound,
                               CandidateMaker& maker, Answer& answer) const {
  for (const CandidateId id : more) {
    for (const CandidateId other : placed)
      if (problem_.collide(set_[id], set_[other])) return;
    placed.push_back(id);
    maker.add(composite, set_[id]);
  }
  const std::int64_t cost = problem_.cost().counts(composite).total();
  if (cost < upper_bound) answer.found = scene_of(std::move(placed), cost);
}

}  // namespace perch
