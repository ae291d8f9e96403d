#include "perch/tree/scene_tree.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace perch {

SceneTree::SceneTree(const LocalizationProblem& problem, CandidateSet& set,
                     std::vector<CandidateMaker>& makers, const Executor& executor,
                     const MonotoneSettings& settings, bool in_context)
    : problem_(problem),
      set_(set),
      makers_(makers),
      executor_(executor),
      settings_(settings),
      in_context_(in_context) {
  settings_.check();
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
  const Observation& observation = problem_.observation();
  Parent parent;
  parent.composite = problem_.cost().empty();
  parent.covered = parent.enclosed = PointSet(observation.size());
  parent.remaining = problem_.copies();
  parent.lagrangian = reduced_costs_.base();
  CandidateMaker& maker = makers_.front();
  for (const CandidateId id : state.placed) {
    const Candidate& candidate = set_[id];
    maker.add(parent.composite, candidate);
    parent.covered.insert_all(candidate.explained);
    parent.enclosed.insert_all(candidate.enclosed);
    --parent.remaining[set_.kind(id)];
    if (upper_bound_) parent.lagrangian += reduced_costs_.reduced_cost(id);
  }
  parent.left_after = static_cast<int>(problem_.object_count() - state.placed.size()) - 1;
  const DepthPatch& depth = parent.composite.depth;
  const float reach = static_cast<float>(parent.left_after * settings_.depth_tolerance);
  parent.charged.assign(depth.depth.size(), 0);
  for (int v = depth.window.v0; v < depth.window.v1; ++v)
    for (int u = depth.window.u0; u < depth.window.u1; ++u) {
      const float z = depth.at(u, v);
      if (!(z < no_surface) || !problem_.cost().index().unexplained_throughout(u, v, z, reach)) continue;
      parent.charged[depth.index(u, v)] = 1;
      ++parent.charged_count;
    }
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
  expansion.complete = executor_.for_each(
      hypotheses.size(),
      [&](std::size_t i, std::size_t worker) {
        CandidateMaker& maker = makers_[worker];
        const Hypothesis& hypothesis = hypotheses[i];
        if (!in_context_ || hypothesis.grid < 0) {
          children[i].id = hypothesis.id;
          value(state, parent, set_[hypothesis.id], maker, children[i]);
          if (upper_bound_ && parent.left_after > 0)
            children[i].bound = std::max(children[i].bound, lagrangian_with(parent, hypothesis.id));
          return;
        }
        std::optional<Candidate>& made = children[i].made;
        made = make_in_context(hypothesis, parent.composite.depth, maker);
        if (!made) return;
        value(state, parent, *made, maker, children[i]);
        made->patch = {};  // too many are made in context to keep their renderings
      },
      stop);
  if (const auto guided = guided_.find(state.placed); guided != guided_.end()) {
    hypotheses_ -= guided->second;
    guided_.erase(guided);
  }
  if (in_context_)
    hypotheses_ += std::count_if(hypotheses.begin(), hypotheses.end(),
                                 [](const Hypothesis& hypothesis) { return hypothesis.grid >= 0; });
  for (Child& child : children)
    if (auto next = add_child(state, std::move(child))) {
      const auto cost = static_cast<double>(next->cost - state.cost);
      expansion.edges.push_back({std::move(*next), cost});
    }
  return expansion;
}

/// Empty where the child is not valid.
std::optional<SceneState> SceneTree::add_child(const State& state, Child child) {
  if (!child.valid) return std::nullopt;
  if (child.made) {
    child.id = set_.add(std::move(*child.made));
    with_volumes_ = set_.size();  // made in context, they come with theirs
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
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (const Hypothesis& hypothesis : hypotheses) {
    Child child;
    child.id = hypothesis.id;
    if (hypothesis.grid >= 0) {
      ++hypotheses_;
      ++guided_[state.placed];
      child.made = make_in_context(hypothesis, parent.composite.depth, maker);
      if (!child.made) continue;
    }
    const Candidate& candidate = child.made ? *child.made : set_[child.id];
    value(state, parent, candidate, maker, child);
    if (!child.valid) continue;
    const auto cost = maker.cost_with(parent.composite, candidate, least - 1);
    if (child.made) child.made->patch = {};
    if (!cost) continue;
    least = *cost;
    best = std::move(child);
  }
  return add_child(state, std::move(best));
}

/// Lazily: where the parent hides nothing that making the hypothesis looks at, it is what it is alone, to the
/// bit, and so is the value of its edge but for the composition. Only the others are refined and rendered
/// again.
std::optional<Candidate> SceneTree::make_in_context(const Hypothesis& hypothesis, const DepthPatch& in_front,
                                                    CandidateMaker& maker) {
  const Pose grid_pose = problem_.grid(hypothesis.model).pose(hypothesis.grid);
  Lone& lone = lone_[hypothesis.model][static_cast<std::size_t>(hypothesis.grid)];
  const auto changed_by = [&](const Sight& seen) {
    const Window common = intersection(seen.window, in_front.window);
    for (int v = common.v0; v < common.v1; ++v)
      for (int u = common.u0; u < common.u1; ++u)
        if (in_front.at(u, v) < seen.farthest) return true;
    return false;
  };
  if (lazy_ && lone.made && !changed_by(lone.seen)) {
    reused_.fetch_add(1, std::memory_order_relaxed);
    return lone.candidate;
  }
  std::optional<Candidate> made = maker.make(hypothesis.model, grid_pose, &in_front);
  if (made) maker.add_volumes(*made);
  if (lazy_ && !lone.made && !changed_by(maker.seen())) {
    lone = {made, maker.seen(), true};
    if (lone.candidate) lone.candidate->patch = {};
  }
  return made;
}

bool SceneTree::collides(const Candidate& candidate, const State& state) const {
  return std::any_of(state.placed.begin(), state.placed.end(),
                     [&](CandidateId id) { return problem_.collide(candidate, set_[id]); });
}

void SceneTree::value(const State& state, const Parent& parent, const Candidate& candidate,
                      CandidateMaker& maker, Child& child) const {
  const DepthPatch& patch = maker.patch(candidate);
  if (!keeps_monotone(problem_.cost(), parent.composite.depth, patch, settings_) ||
      collides(candidate, state))
    return;
  child.valid = true;
  if (parent.left_after == 0) {
    // The last edge takes the rest, the residual of the paper included.
    child.cost = child.bound = *maker.cost_with(parent.composite, patch);
    return;
  }
  const std::int64_t rendered = std::max<std::int64_t>(
      0, charged_with(parent, patch) - std::int64_t{parent.left_after} * settings_.pixel_tolerance);
  PointSet covered = parent.covered, enclosed = parent.enclosed;
  covered.insert_all(candidate.explained);
  enclosed.insert_all(candidate.enclosed);
  const auto observed = static_cast<std::int64_t>(enclosed.count_not_in(covered));
  child.cost = child.bound = rendered + observed;
  if (!cover_bound_) return;
  std::vector<int> remaining = parent.remaining;
  --remaining[problem_.kind_of(candidate.model)];
  child.bound =
      rendered + std::max(observed, (*cover_bound_)(covered, problem_.cost().charged_points(), remaining));
}

std::int64_t SceneTree::charged_with(const Parent& parent, const DepthPatch& patch) const {
  const DepthPatch& depth = parent.composite.depth;
  const float reach = static_cast<float>(parent.left_after * settings_.depth_tolerance);
  std::int64_t charged = parent.charged_count;
  for (int v = patch.window.v0; v < patch.window.v1; ++v)
    for (int u = patch.window.u0; u < patch.window.u1; ++u) {
      const float z = patch.at(u, v);
      if (!(z < no_surface)) continue;
      const float hidden = depth.at_or_none(u, v);
      if (!(z < hidden) || !problem_.cost().counts_at(u, v, z)) continue;
      if (hidden < no_surface) charged -= parent.charged[depth.index(u, v)];
      charged += problem_.cost().index().unexplained_throughout(u, v, z, reach);
    }
  return charged;
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
