#include "perch/tree/child_valuation.hpp"

#include <algorithm>
#include <utility>

namespace perch {

ChildValuation::ChildValuation(const LocalizationProblem& problem, const MonotoneSettings& settings,
                               bool in_context)
    : problem_(problem), settings_(settings), lone_(in_context ? problem.models().size() : 0) {
  settings_.check();
  for (std::size_t model = 0; model < lone_.size(); ++model)
    if (problem.copies()[problem.kind_of(model)] > 0)
      lone_[model].resize(static_cast<std::size_t>(problem.grid(model).size()));
}

ParentScene ChildValuation::parent(std::vector<const Candidate*> placed, CandidateMaker& maker) const {
  ParentScene parent;
  parent.composite = problem_.cost().empty();
  parent.covered = parent.enclosed = PointSet(problem_.observation().size());
  for (const Candidate* candidate : placed) {
    maker.add(parent.composite, *candidate);
    parent.covered.insert_all(candidate->explained);
    parent.enclosed.insert_all(candidate->enclosed);
  }
  parent.left_after = static_cast<int>(problem_.object_count() - placed.size()) - 1;
  parent.placed = std::move(placed);
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

ChildValuation::Value ChildValuation::value(const ParentScene& parent, const Candidate& candidate,
                                            CandidateMaker& maker) const {
  Value value;
  const DepthPatch& patch = maker.patch(candidate);
  if (!keeps_monotone(problem_.cost(), parent.composite.depth, patch, settings_) ||
      std::any_of(parent.placed.begin(), parent.placed.end(),
                  [&](const Candidate* placed) { return problem_.collide(candidate, *placed); }))
    return value;
  value.valid = true;
  if (parent.left_after == 0) {
    // The last edge takes the rest, the residual of the paper included.
    value.cost = *maker.cost_with(parent.composite, patch);
    return value;
  }
  value.rendered = std::max<std::int64_t>(
      0, charged_with(parent, patch) - std::int64_t{parent.left_after} * settings_.pixel_tolerance);
  value.covered = parent.covered;
  value.covered.insert_all(candidate.explained);
  PointSet enclosed = parent.enclosed;
  enclosed.insert_all(candidate.enclosed);
  value.cost = value.rendered + static_cast<std::int64_t>(enclosed.count_not_in(value.covered));
  return value;
}

std::int64_t ChildValuation::charged_with(const ParentScene& parent, const DepthPatch& patch) const {
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

ChildValuation::InContext ChildValuation::make(std::size_t model, std::int64_t grid_pose, bool known,
                                               const DepthPatch& in_front, CandidateMaker& maker) {
  Lone& lone = lone_[model][static_cast<std::size_t>(grid_pose)];
  const auto changed_by = [&](const Sight& seen) {
    const Window common = intersection(seen.window, in_front.window);
    for (int v = common.v0; v < common.v1; ++v)
      for (int u = common.u0; u < common.u1; ++u)
        if (in_front.at(u, v) < seen.farthest) return true;
    return false;
  };
  if (lazy_ && lone.made && !changed_by(lone.seen)) return {lone.candidate, true};
  const Work before = maker.effort().work;
  std::optional<Candidate> made = maker.make(model, problem_.grid(model).pose(grid_pose), &in_front);
  if (made) maker.add_volumes(*made);
  if (!lazy_ || changed_by(maker.seen())) return {std::move(made), false};
  if (!lone.made) {
    lone = {made, maker.seen(), true};
    if (lone.candidate) lone.candidate->patch = {};
  }
  if (known) {
    Effort effort = maker.effort();
    effort.work = before;
    ++effort.made_again;
    if (made && !made->patch.window.empty()) effort.work.add_rendering(made->window);
    maker.set_effort(effort);
  }
  return {std::move(made), true};
}

}  // namespace perch
