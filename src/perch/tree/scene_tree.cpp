#include "perch/tree/scene_tree.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "perch/tree/children_batch.hpp"

namespace perch {

SceneTree::SceneTree(const LocalizationProblem& problem, CandidateSet& set,
                     std::vector<CandidateMaker>& makers, const Executor& executor,
                     const MonotoneSettings& settings, bool in_context)
    : problem_(problem),
      set_(set),
      makers_(makers),
      executor_(executor),
      settings_(settings),
      in_context_(in_context),
      valuation_(problem, settings, in_context) {
  if (!in_context) {
    cover_bound_.emplace(set, problem.kinds());
    return;
  }
  for (std::size_t model = 0; model < problem.models().size(); ++model) {
    const std::size_t kind = problem.kind_of(model);
    lone_.emplace_back(problem.copies()[kind] == 0 ? 0
                                                   : static_cast<std::size_t>(problem.grid(model).size()));
    if (problem.optional(kind) && model == problem.bodies_of(kind).front()) set.add(absent_candidate(model));
  }
}

SceneTree SceneTree::fixed(const LocalizationProblem& problem, CandidateSet& set,
                           std::vector<CandidateMaker>& makers, const Executor& executor,
                           const MonotoneSettings& settings) {
  return SceneTree(problem, set, makers, executor, settings, false);
}

SceneTree SceneTree::in_context(const LocalizationProblem& problem, CandidateSet& set,
                                std::vector<CandidateMaker>& makers, const Executor& executor,
                                const MonotoneSettings& settings) {
  return SceneTree(problem, set, makers, executor, settings, true);
}

void SceneTree::use(const ReducedCosts& reduced_costs, std::int64_t lower_bound, std::int64_t upper_bound) {
  reduced_costs_ = reduced_costs;
  lower_bound_ = std::min(lower_bound, upper_bound);
  upper_bound_ = upper_bound;
}

SceneTree::State SceneTree::root() const {
  State root;
  if (cover_bound_) {
    const PointSet nothing(problem_.observation().size());
    root.bound = (*cover_bound_)(nothing, problem_.cost().charged_points(), problem_.copies());
  }
  root.bound = std::max(root.bound, lower_bound_);
  return root;
}

SceneTree::Parent SceneTree::make_parent(const State& state) const {
  Parent parent;
  parent.remaining = problem_.copies();
  parent.lagrangian = reduced_costs_.base();
  std::vector<const Candidate*> placed;
  for (const CandidateId id : state.placed) {
    placed.push_back(&set_[id]);
    --parent.remaining[set_.kind(id)];
    if (upper_bound_) parent.lagrangian += reduced_costs_.reduced_cost(id);
  }
  parent.scene = valuation_.parent(std::move(placed), makers_.front());
  return parent;
}

std::vector<SceneTree::Hypothesis> SceneTree::hypotheses_of(const Parent& parent) const {
  std::vector<Hypothesis> hypotheses;
  for (std::size_t kind = 0; kind < parent.remaining.size(); ++kind) {
    if (parent.remaining[kind] == 0) continue;
    if (in_context_) {
      for (const std::size_t model : problem_.bodies_of(kind)) {
        const auto poses = static_cast<std::int64_t>(problem_.grid(model).size());
        for (std::int64_t i = 0; i < poses; ++i) hypotheses.push_back({model, 0, i});
      }
      for (const CandidateId id : set_.of_kind(kind))
        if (set_[id].absent) hypotheses.push_back({set_[id].model, id, -1});
    } else {
      for (const CandidateId id : set_.of_kind(kind))
        if (!upper_bound_ || lagrangian_with(parent, id) < *upper_bound_)
          hypotheses.push_back({set_[id].model, id, 0});
    }
  }
  return hypotheses;
}

std::int64_t SceneTree::lagrangian_with(const Parent& parent, CandidateId id) const {
  return Lagrangian::count(parent.lagrangian + reduced_costs_.reduced_cost(id));
}

bool SceneTree::add_volumes(const StopCondition& stop) {
  const std::size_t first = with_volumes_;
  const bool complete = executor_.for_each(
      set_.size() - first,
      [&](std::size_t i, std::size_t worker) {
        makers_[worker].add_volumes(set_[static_cast<CandidateId>(first + i)]);
      },
      stop);
  if (complete) with_volumes_ = set_.size();
  return complete;
}

Expansion<SceneState> SceneTree::expand(const State& state, const StopCondition& stop) {
  Expansion<State> expansion;
  if (!add_volumes(stop)) return {{}, false};
  const Parent parent = make_parent(state);
  const std::vector<Hypothesis> hypotheses = hypotheses_of(parent);
  std::vector<Child> children(hypotheses.size());
  expansion.complete = in_context_
                           ? value_in_context(parent, hypotheses, stop, children)
                           : executor_.for_each(
                                 hypotheses.size(),
                                 [&](std::size_t i, std::size_t worker) {
                                   value_fixed(parent, hypotheses[i].id, makers_[worker], children[i]);
                                 },
                                 stop);
  if (const auto guided = guided_.find(state.placed); guided != guided_.end()) {
    hypotheses_ -= guided->second;
    guided_.erase(guided);
  }
  if (in_context_)
    hypotheses_ += std::count_if(hypotheses.begin(), hypotheses.end(),
                                 [](const Hypothesis& hypothesis) { return hypothesis.grid >= 0; });
  for (std::size_t i = 0; i < children.size(); ++i)
    if (auto next = add_child(state, hypotheses[i], std::move(children[i]))) {
      const auto cost = static_cast<double>(next->cost - state.cost);
      expansion.edges.push_back({std::move(*next), cost});
    }
  return expansion;
}

void SceneTree::value_fixed(const Parent& parent, CandidateId id, CandidateMaker& maker, Child& child) const {
  const ChildValuation::Value value = valuation_.value(parent.scene, set_[id], maker);
  child.id = id;
  child.valid = value.valid;
  child.cost = child.bound = value.cost;
  if (!value.valid || parent.scene.left_after == 0) return;
  if (cover_bound_) {
    std::vector<int> remaining = parent.remaining;
    --remaining[set_.kind(id)];
    const std::int64_t observed = (*cover_bound_)(value.covered, problem_.cost().charged_points(), remaining);
    child.bound = std::max(child.bound, value.rendered + observed);
  }
  if (upper_bound_) child.bound = std::max(child.bound, lagrangian_with(parent, id));
}

bool SceneTree::value_in_context(const Parent& parent, const std::vector<Hypothesis>& hypotheses,
                                 const StopCondition& stop, std::vector<Child>& children) {
  std::vector<ChildrenBatch::Hypothesis> asked;
  for (const Hypothesis& hypothesis : hypotheses) {
    const bool left_out = hypothesis.grid < 0;
    asked.push_back({hypothesis.model, hypothesis.grid, !left_out && lone(hypothesis).made,
                     !left_out && lone(hypothesis).id.has_value()});
  }
  ChildrenBatch batch(problem_, settings_, parent.scene, std::move(asked), valuation_, makers_);
  const bool complete = executor_.spread(batch, stop);
  makers_.front().credit(batch.effort_elsewhere);
  for (std::size_t i = 0; i < children.size(); ++i) {
    ChildrenBatch::Child& answer = batch.children[i];
    Child& child = children[i];
    child.id = hypotheses[i].id;
    child.valid = answer.valid;
    child.cost = child.bound = answer.cost;
    child.as_alone = answer.as_alone;
    child.made = std::move(answer.made);
    if (!child.as_alone) continue;
    Lone& alone = lone(hypotheses[i]);
    if (std::exchange(alone.made, true)) ++reused_;
    if (!child.made && alone.id) child.id = *alone.id;
  }
  return complete;
}

/// Empty where the child is not valid.
std::optional<SceneState> SceneTree::add_child(const State& state, const Hypothesis& hypothesis,
                                               Child child) {
  if (!child.valid) return std::nullopt;
  if (child.made) {
    child.id = set_.add(std::move(*child.made));
    with_volumes_ = set_.size();  // made in context, they come with theirs
    if (child.as_alone) lone(hypothesis).id = child.id;
  }
  State next;
  next.placed = state.placed;
  next.placed.insert(std::upper_bound(next.placed.begin(), next.placed.end(), child.id), child.id);
  next.cost = child.cost;
  next.bound = child.bound;
  return next;
}

std::optional<SceneState> SceneTree::guided_by(const std::vector<PriorPose>& priors) {
  std::vector<PriorPose> ordered = priors;
  const auto depth = [&](const PriorPose& prior) {
    return problem_.camera_from_model(prior.model, prior.pose).translation().z();
  };
  std::stable_sort(ordered.begin(), ordered.end(),
                   [&](const PriorPose& a, const PriorPose& b) { return depth(a) < depth(b); });
  std::vector<std::vector<Hypothesis>> steps;
  std::vector<int> left = problem_.copies();
  for (const PriorPose& prior : ordered)
    if (left[problem_.kind_of(prior.model)]-- > 0) steps.push_back(near(prior));
  for (std::size_t kind = 0; kind < left.size(); ++kind)
    for (const CandidateId id : set_.of_kind(kind))
      if (set_[id].absent && left[kind] > 0)
        steps.insert(steps.end(), static_cast<std::size_t>(left[kind]), {{set_[id].model, id, -1}});
  if (steps.size() != problem_.object_count()) return std::nullopt;

  State state = root();
  for (const std::vector<Hypothesis>& hypotheses : steps) {
    auto next = best_child(state, hypotheses);
    if (!next) return std::nullopt;
    state = std::move(*next);
  }
  return state;
}

/// The grid poses nearest to a prior, the nearest first.
std::vector<SceneTree::Hypothesis> SceneTree::near(const PriorPose& prior) const {
  constexpr std::size_t most = 8;  // the corners of the grid's cell around it
  const PoseGrid& grid = problem_.grid(prior.model);
  std::vector<std::pair<double, std::int64_t>> poses;
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(grid.size()); ++i)
    poses.emplace_back(pose_distance(problem_.models()[prior.model], grid.pose(i), prior.pose), i);
  const std::size_t n = std::min(most, poses.size());
  std::partial_sort(poses.begin(), poses.begin() + static_cast<std::ptrdiff_t>(n), poses.end());
  std::vector<Hypothesis> hypotheses;
  for (std::size_t i = 0; i < n; ++i) hypotheses.push_back({prior.model, 0, poses[i].second});
  return hypotheses;
}

/// Of some children the one whose scene, as far as it is placed, has the least J.
std::optional<SceneState> SceneTree::best_child(const State& state,
                                                const std::vector<Hypothesis>& hypotheses) {
  CandidateMaker& maker = makers_.front();
  const Parent parent = make_parent(state);
  Child best;
  const Hypothesis* chosen = &hypotheses.front();
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (const Hypothesis& hypothesis : hypotheses) {
    Child child;
    child.id = hypothesis.id;
    if (hypothesis.grid >= 0) {
      ++hypotheses_;
      ++guided_[state.placed];
      Lone& alone = lone(hypothesis);
      auto made =
          valuation_.make(hypothesis.model, hypothesis.grid, alone.made, parent.scene.composite.depth, maker);
      child.as_alone = made.as_alone;
      if (made.as_alone && std::exchange(alone.made, true)) ++reused_;
      if (!made.candidate) continue;
      child.made = std::move(made.candidate);
    }
    const Candidate& candidate = child.made ? *child.made : set_[child.id];
    const ChildValuation::Value value = valuation_.value(parent.scene, candidate, maker);
    child.valid = value.valid;
    child.cost = child.bound = value.cost;
    if (!child.valid) continue;
    const auto cost = maker.cost_with(parent.scene.composite, candidate, least - 1);
    if (child.made) child.made->patch = {};
    if (!cost) continue;
    least = *cost;
    best = std::move(child);
    chosen = &hypothesis;
  }
  return add_child(state, *chosen, std::move(best));
}

SceneTree::State SceneTree::state_of(std::vector<CandidateId> placed) const {
  std::sort(placed.begin(), placed.end());
  State state;
  state.placed = std::move(placed);
  if (!is_goal(state)) throw std::logic_error("SceneTree::state_of: not a whole scene");
  Composite composite = problem_.cost().empty();
  CandidateMaker& maker = makers_.front();
  for (const CandidateId id : state.placed) maker.add(composite, set_[id]);
  state.cost = state.bound = problem_.cost().counts(composite).total();
  return state;
}

bool SceneTree::contains(const std::vector<CandidateId>& placed) const {
  std::vector<DepthPatch> patches;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    patches.push_back(makers_.front().patch(set_[placed[i]]));
    for (std::size_t j = 0; j < i; ++j) {
      if (problem_.collide(set_[placed[i]], set_[placed[j]])) return false;
    }
  }
  return monotone_order_exists(problem_.cost(), patches, settings_);
}

}  // namespace perch
