#include "perch/tree/scene_branching.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "perch/tree/renderings_to_keep.hpp"

namespace perch {
namespace {

bool cheaper(const OpenSlot::Choice& a, const OpenSlot::Choice& b) {
  return std::tie(a.reduced_cost, a.id) < std::tie(b.reduced_cost, b.id);
}

/// Every node looks at what its choices render. Those that were drawn in other processes, and would be kept
/// had they been drawn here, take no memory from others, so that the same are drawn again however many
/// processes there are.
void keep_renderings(const std::vector<char>& kept, CandidateSet& set, std::vector<CandidateMaker>& makers,
                     const Executor& executor, const StopCondition& stop) {
  RenderingsToKeep renderings;
  for (CandidateId id = 0; id < kept.size(); ++id) {
    const Candidate& candidate = set[id];
    if (!kept[id] || candidate.absent || !candidate.patch.window.empty()) continue;
    if (candidate.drawn_elsewhere)
      renderings.add_always(id);
    else
      renderings.add(id, candidate.window);
  }
  const std::vector<CandidateId>& ids = renderings.ids();
  executor.for_each(
      ids.size(),
      [&](std::size_t i, std::size_t worker) { set[ids[i]].patch = makers[worker].patch(set[ids[i]]); },
      stop);
}

/// What is left beside the choice that a node takes, before collisions are looked at.
OpenNode open_node(const SceneBranching::Node& node, std::int64_t upper_bound) {
  const SceneBranching::Family& family = *node.family;
  const OpenSlot::Choice& taken = family.slots[family.branching_slot].choices[node.choice];
  OpenNode result;
  result.placed = family.placed;
  result.placed.push_back(taken.id);
  for (std::size_t s = 0; s < family.slots.size(); ++s) {
    const bool own = s == family.branching_slot;
    OpenSlot slot{family.slots[s].copies - static_cast<int>(own), family.slots[s].origin, {}};
    if (slot.copies == 0) continue;
    const auto& choices = family.slots[s].choices;
    for (std::size_t i = own ? node.choice : 0; i < choices.size(); ++i) {
      if (Lagrangian::count(family.base + taken.reduced_cost + choices[i].reduced_cost) >= upper_bound) break;
      slot.choices.push_back(choices[i]);
    }
    result.slots.push_back(std::move(slot));
  }
  return result;
}

std::vector<OpenNode> open_nodes(const std::vector<SceneBranching::Node>& nodes, std::int64_t upper_bound) {
  std::vector<OpenNode> result;
  for (const SceneBranching::Node& node : nodes) result.push_back(open_node(node, upper_bound));
  return result;
}

}  // namespace

SceneBranching::SceneBranching(const LocalizationProblem& problem, CandidateSet& set,
                               std::vector<CandidateMaker>& makers, const Executor& executor,
                               const LagrangianBound& bound, const StopCondition& stop, double share_after)
    : bound_(bound.lower_bound()),
      work_(problem, set, bound.kept(), bound.point_weights(), makers, executor, share_after) {
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
  keep_renderings(kept, set, makers, executor, stop);
}

std::vector<SceneBranching::Answer> SceneBranching::branch(const std::vector<Node>& nodes, double upper_bound,
                                                           const StopCondition& stop) {
  // Costs are whole: what costs less than the upper bound costs at most one less.
  const std::int64_t limit =
      upper_bound < 1e12 ? static_cast<std::int64_t>(upper_bound) : std::int64_t{1} << 40;
  if (nodes.front().is_root) return {branch_root(limit, stop)};
  std::vector<OpenNode> opened = open_nodes(nodes, limit);
  std::vector<NodeFinding> findings = work_.work(opened, limit, stop);
  std::vector<Answer> answers(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    NodeFinding& finding = findings[i];
    answers[i].found = std::move(finding.found);
    answers[i].complete = finding.complete;
    if (finding.slots.empty()) continue;
    auto family = std::make_shared<Family>();
    family->placed = std::move(opened[i].placed);
    family->base = finding.base;
    family->slots = std::move(finding.slots);
    family->branching_slot = slot_to_branch(family->slots);
    answers[i].children = children(family, std::max(nodes[i].bound, finding.bound), limit);
  }
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (answers[i].complete) learn(nodes[i], std::min(findings[i].bound, limit));
  return answers;
}

SceneBranching::Answer SceneBranching::branch_root(std::int64_t upper_bound, const StopCondition& stop) {
  look_ahead(upper_bound, stop);
  Answer answer;
  answer.complete = !stop();
  if (answer.complete) answer.children = children(root_, bound_, upper_bound);
  return answer;
}

void SceneBranching::learn(const Node& node, std::int64_t bound) {
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
  const std::vector<NodeFinding> findings = work_.work(open_nodes(nodes, upper_bound), upper_bound, stop);
  if (stop()) return;
  for (std::size_t i = 0; i < nodes.size();) {
    std::size_t least = i;
    const auto& family = nodes[i].family;
    for (; i < nodes.size() && nodes[i].family == family; ++i)
      if (findings[i].bound < findings[least].bound) least = i;
    learn(nodes[least], std::min(findings[least].bound, upper_bound));
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

std::vector<SceneBranching::Node> SceneBranching::children(const std::shared_ptr<const Family>& family,
                                                           std::int64_t lower_bound,
                                                           std::int64_t upper_bound) const {
  std::vector<Node> nodes;
  const OpenSlot& slot = family->slots[family->branching_slot];
  for (std::size_t i = 0; i < slot.choices.size(); ++i) {
    // The other copies come after it in the list, so each adds no less.
    const std::int64_t bound =
        std::max(lower_bound, Lagrangian::count(family->base + slot.copies * slot.choices[i].reduced_cost));
    if (bound >= upper_bound) break;  // and so are all after it
    nodes.push_back({family, i, false, bound});
  }
  return nodes;
}

}  // namespace perch
