#include "perch/localize/report.hpp"

#include <algorithm>
#include <optional>
#include <tuple>

#include "perch/render/rasterizer.hpp"

namespace perch {
namespace {

std::vector<DepthPatch> render_each(const LocalizationProblem& problem,
                                    const std::vector<PlacedModel>& placed) {
  Rasterizer rasterizer(problem.observation().intrinsics());
  std::vector<DepthPatch> patches(placed.size());
  for (std::size_t i = 0; i < placed.size(); ++i)
    problem.render(placed[i].model, placed[i].pose, rasterizer, patches[i]);
  return patches;
}

Composite composite_of(const LocalizationProblem& problem, const std::vector<DepthPatch>& patches) {
  Composite composite = problem.cost().empty();
  CostChange scratch;
  for (const DepthPatch& patch : patches) problem.cost().add(composite, patch, scratch);
  return composite;
}

CostRecord record_of(const CostCounts& counts) {
  return {counts.total(), counts.observed, counts.rendered};
}

}  // namespace

std::optional<int> rest_pose(const LocalizationProblem& problem, std::size_t body) {
  const RestPose& rest = problem.models()[body].rest();
  return rest.only ? std::nullopt : std::optional(rest.index);
}

std::vector<PlacedModel> in_scene_order(const LocalizationProblem& problem, std::vector<PlacedModel> placed) {
  const auto rank = [&](const PlacedModel& p) {
    return std::tuple(problem.kind_of(p.model), p.pose.x, p.pose.y, p.pose.yaw, p.model);
  };
  std::sort(placed.begin(), placed.end(),
            [&](const PlacedModel& a, const PlacedModel& b) { return rank(a) < rank(b); });
  std::vector<PlacedModel> ordered;
  for (const std::size_t kind : problem.objects()) {
    const auto next = std::find_if(placed.begin(), placed.end(),
                                   [&](const PlacedModel& p) { return problem.kind_of(p.model) == kind; });
    if (next == placed.end()) continue;
    ordered.push_back(*next);
    placed.erase(next);
  }
  return ordered;
}

void report_search(const LocalizationProblem& problem, const std::vector<PlacedModel>& placed,
                   Result& result) {
  result.search_objects.clear();
  for (const PlacedModel& object : in_scene_order(problem, placed))
    result.search_objects.push_back(
        {problem.models()[object.model].name(), object.pose, rest_pose(problem, object.model)});
}

void report_scene(const LocalizationProblem& problem, const std::vector<PlacedModel>& unordered,
                  Result& result) {
  const std::vector<PlacedModel> placed = in_scene_order(problem, unordered);
  result.objects.clear();
  std::size_t met = 0;
  for (const std::size_t kind : problem.objects()) {
    ObjectResult& object = result.objects.emplace_back();
    object.model = problem.models()[problem.bodies_of(kind).front()].name();
    object.absent = met == placed.size() || problem.kind_of(placed[met].model) != kind;
    if (object.absent) continue;
    const std::size_t body = placed[met].model;
    object.pose = placed[met++].pose;
    object.rest_pose = rest_pose(problem, body);
    object.world_from_model = problem.models()[body].world_from_unturned(object.pose);
    object.camera_from_model = problem.camera_from_unturned(body, object.pose);
  }

  const std::vector<DepthPatch> patches = render_each(problem, placed);
  result.cost = record_of(problem.cost().counts(composite_of(problem, patches)));
  std::vector<const DepthPatch*> pointers;
  for (const DepthPatch& patch : patches) pointers.push_back(&patch);
  const DepthPatch scene = compose(pointers);

  std::size_t next = 0;
  for (ObjectResult& object : result.objects) {
    if (object.absent) continue;
    const auto i = static_cast<std::ptrdiff_t>(next++);
    const DepthPatch& patch = patches[static_cast<std::size_t>(i)];
    std::int64_t alone = 0, explained = 0;
    for (int v = patch.window.v0; v < patch.window.v1; ++v)
      for (int u = patch.window.u0; u < patch.window.u1; ++u) {
        const float z = patch.at(u, v);
        if (!(z < no_surface)) continue;
        ++alone;
        // Of two at the same depth the first in the scene's order is the one seen.
        const bool first = std::none_of(patches.begin(), patches.begin() + i,
                                        [&](const DepthPatch& other) { return other.at_or_none(u, v) == z; });
        if (z > scene.at(u, v) || !first) continue;
        ++object.visible_pixels;
        explained += problem.cost().index().explained(u, v, z);
      }
    if (alone > 0)
      object.visible_fraction = static_cast<double>(object.visible_pixels) / static_cast<double>(alone);
    if (object.visible_pixels > 0)
      object.explained_fraction = static_cast<double>(explained) / static_cast<double>(object.visible_pixels);
  }
}

void report_judged(const LocalizationProblem& problem, const JudgedScene& judged, Result& result) {
  report_scene(problem, judged.scene.placed, result);
  for (std::size_t i = 0; i < judged.objects.size(); ++i) {
    const PlacedModel& placed = judged.scene.placed[i];
    const auto object =
        std::find_if(result.objects.begin(), result.objects.end(), [&](const ObjectResult& o) {
          return o.model == problem.models()[placed.model].name() && o.pose == placed.pose &&
                 o.rest_pose == rest_pose(problem, placed.model) && !o.confidence;
        });
    object->confidence = judged.objects[i].confidence;
    object->runner_up = judged.objects[i].runner_up;
  }
}

ScoreRecord score_scene(const LocalizationProblem& problem, const std::vector<PlacedModel>& placed,
                        const MonotoneSettings& settings) {
  const std::vector<DepthPatch> patches = render_each(problem, placed);
  const Composite composite = composite_of(problem, patches);
  ScoreRecord record;
  record.cost = record_of(problem.cost().counts(composite));
  record.rendered_points = composite.points;
  record.observed_points = static_cast<std::int64_t>(problem.observation().size());
  record.monotone = monotone_order_exists(problem.cost(), patches, settings);
  for (std::size_t i = 0; i < placed.size(); ++i)
    for (std::size_t j = 0; j < i && !record.collides; ++j)
      record.collides = problem.collide(placed[i].model, placed[i].pose, placed[j].model, placed[j].pose);
  return record;
}

}  // namespace perch
