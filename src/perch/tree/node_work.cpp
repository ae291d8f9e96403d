#include "perch/tree/node_work.hpp"

#include <algorithm>
#include <utility>

namespace perch {
namespace {

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

NodeFinding NodeWork::work(const OpenNode& node, std::int64_t upper_bound, CandidateMaker& maker,
                           const StopCondition& stop) const {
  NodeFinding finding;
  finding.complete = true;
  finding.bound = upper_bound;
  const std::vector<OpenSlot> slots = slots_beside_last(node);
  if (std::any_of(slots.begin(), slots.end(), [](const OpenSlot& slot) { return slot.choices.empty(); }))
    return finding;
  Composite composite = problem_.cost().empty();
  for (const CandidateId id : node.placed) maker.add(composite, set_[id]);
  if (open_copies(slots) < 2) {
    complete(composite, node.placed, slots, upper_bound, maker, stop, finding);
    return finding;
  }
  PartialBound partial =
      bound_partial_scene(problem_, set_, composite, slots, point_weights_, upper_bound, maker, stop);
  finding.complete = partial.complete;
  finding.bound = partial.lower_bound;
  if (!partial.complete || partial.lower_bound >= upper_bound) return finding;
  try_scene(std::move(composite), node.placed, partial.best, upper_bound, maker, finding);
  finding.base = partial.base;
  finding.slots = std::move(partial.slots);
  return finding;
}

std::vector<OpenSlot> NodeWork::slots_beside_last(const OpenNode& node) const {
  std::vector<OpenSlot> slots;
  for (const OpenSlot& all : node.slots) {
    OpenSlot slot{all.copies, all.origin, {}};
    for (const OpenSlot::Choice& choice : all.choices)
      if (!problem_.collide(set_[node.placed.back()], set_[choice.id])) slot.choices.push_back(choice);
    slots.push_back(std::move(slot));
  }
  return slots;
}

/// At most one object is left: every choice is valued exactly.
void NodeWork::complete(const Composite& composite, const std::vector<CandidateId>& placed,
                        const std::vector<OpenSlot>& last, std::int64_t upper_bound, CandidateMaker& maker,
                        const StopCondition& stop, NodeFinding& finding) const {
  if (last.empty()) {
    const std::int64_t cost = problem_.cost().counts(composite).total();
    if (cost < upper_bound) finding.found = scene_of(placed, cost);
    return;
  }
  std::int64_t best = upper_bound;
  for (const OpenSlot::Choice& choice : last.front().choices) {
    if (stop()) {
      finding.complete = false;
      return;
    }
    const auto cost = maker.cost_with(composite, set_[choice.id], best - 1);
    if (!cost) continue;
    best = *cost;
    std::vector<CandidateId> scene = placed;
    scene.push_back(choice.id);
    finding.found = scene_of(std::move(scene), best);
  }
}

/// The scene that the weights favour is often a good one.
void NodeWork::try_scene(Composite composite, std::vector<CandidateId> placed,
                         const std::vector<CandidateId>& more, std::int64_t upper_bound,
                         CandidateMaker& maker, NodeFinding& finding) const {
  for (const CandidateId id : more) {
    for (const CandidateId other : placed)
      if (problem_.collide(set_[id], set_[other])) return;
    placed.push_back(id);
    maker.add(composite, set_[id]);
  }
  const std::int64_t cost = problem_.cost().counts(composite).total();
  if (cost < upper_bound) finding.found = scene_of(std::move(placed), cost);
}

}  // namespace perch
