#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <vector>

#include "perch/candidates/fixed_candidates.hpp"
#include "perch/localize/object_trials.hpp"
#include "perch/localize/setup.hpp"
#include "perch/observation/delta_index.hpp"
#include "perch/render/rasterizer.hpp"
#include "perch/sim/parametric_models.hpp"
#include "perch/sim/scene_generator.hpp"

namespace perch {

/// A simulated scene made ready for what comes after a search.
struct FinishProblem {
  Scene scene;
  Settings settings;
  SerialExecutor executor;
  std::unique_ptr<LocalizationProblem> problem;
  std::vector<CandidateMaker> makers;
  std::optional<FixedCandidates> candidates;

  explicit FinishProblem(Scene simulated) : scene(std::move(simulated)) {
    settings.candidates.grid.resolution = 0.08;
    settings.candidates.grid.yaw_resolution = 0.7854;
    problem = make_problem(scene, settings, executor);
    makers = make_makers(*problem, executor);
  }
  FinishProblem(const FinishProblem&) = delete;  // the candidates refer to the others
  FinishProblem& operator=(const FinishProblem&) = delete;

  void refine_candidates() {
    candidates.emplace(*problem, makers, executor);
    candidates->refine(StopCondition());
  }
  /// Valued, all of them.
  void make_candidates() {
    refine_candidates();
    candidates->value_all(StopCondition());
  }
  CandidateSet& set() { return candidates->set(); }

  /// J by its definition: every point of I against every rendered point.
  std::int64_t brute_force_cost(const std::vector<PlacedModel>& placed) const {
    Rasterizer rasterizer(scene.camera.intrinsics);
    std::vector<DepthPatch> patches(placed.size());
    std::vector<const DepthPatch*> all;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      problem->render(placed[i].model, placed[i].pose, rasterizer, patches[i]);
      all.push_back(&patches[i]);
    }
    const DepthPatch composite = compose(all);
    const Observation& observation = problem->observation();
    std::vector<Eigen::Vector3f> rendered;
    for (int v = composite.window.v0; v < composite.window.v1; ++v)
      for (int u = composite.window.u0; u < composite.window.u1; ++u)
        if (composite.at(u, v) < no_surface && problem->cost().counts_at(u, v, composite.at(u, v)))
          rendered.push_back(observation.rays().point(u, v, composite.at(u, v)));
    const float delta_squared = problem->cost().index().delta_squared();
    std::vector<char> explained(rendered.size(), 0);
    std::int64_t cost = 0;
    for (const Eigen::Vector3f& p : observation.points()) {
      bool found = false;
      for (std::size_t i = 0; i < rendered.size(); ++i)
        if (within_delta(p, rendered[i], delta_squared)) {
          explained[i] = 1;
          found = true;
        }
      cost += !found;
    }
    return cost + std::count(explained.begin(), explained.end(), 0);
  }

  /// A scene with its exact J, counted the quick way.
  ArrangedScene arranged(std::vector<PlacedModel> placed) const {
    Rasterizer rasterizer(scene.camera.intrinsics);
    Composite composite = problem->cost().empty();
    CostChange scratch;
    DepthPatch patch;
    for (const PlacedModel& object : placed) {
      problem->render(object.model, object.pose, rasterizer, patch);
      problem->cost().add(composite, patch, scratch);
    }
    return {std::move(placed), problem->cost().counts(composite).total()};
  }

  ArrangedScene truth() const {
    std::vector<PlacedModel> placed;
    for (const TruthPose& t : scene.truth)
      placed.push_back(
          {t.model, {t.pose.x, t.pose.y, scene.models[t.model].symmetry.canonical_yaw(t.pose.yaw)}});
    return arranged(std::move(placed));
  }

  bool collision_free(const std::vector<PlacedModel>& placed) const {
    for (std::size_t i = 0; i < placed.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (problem->collide(placed[i].model, placed[i].pose, placed[j].model, placed[j].pose)) return false;
    return true;
  }

  /// What every scene must be: complete, inside the workspaces, free of collisions, its yaws canonical, its
  /// cost exact.
  void expect_valid(const ArrangedScene& arranged) const {
    ASSERT_EQ(arranged.placed.size(), scene.objects.size());
    EXPECT_TRUE(collision_free(arranged.placed));
    for (const PlacedModel& object : arranged.placed) {
      const Workspace& workspace = problem->workspace(object.model);
      EXPECT_GE(object.pose.x, workspace.x_min);
      EXPECT_LE(object.pose.x, workspace.x_max);
      EXPECT_GE(object.pose.y, workspace.y_min);
      EXPECT_LE(object.pose.y, workspace.y_max);
      EXPECT_EQ(object.pose.yaw, scene.models[object.model].symmetry.canonical_yaw(object.pose.yaw));
    }
    EXPECT_EQ(arranged.cost, brute_force_cost(arranged.placed));
  }
};

inline bool same(const ArrangedScene& a, const ArrangedScene& b) {
  if (a.cost != b.cost || a.placed.size() != b.placed.size()) return false;
  for (std::size_t i = 0; i < a.placed.size(); ++i)
    if (a.placed[i].model != b.placed[i].model || !(a.placed[i].pose == b.placed[i].pose)) return false;
  return true;
}

inline TabletopOptions small_view(int objects, bool noise) {
  TabletopOptions options;
  options.min_objects = options.max_objects = objects;
  options.noise = noise;
  options.width = 160;
  options.height = 120;
  options.least_visible = 0.3;
  return options;
}

/// A layout on a table without noise, seen from the -y side, 33 degrees from above.
inline Scene staged(const std::vector<SceneModel>& models, const std::vector<PlacedModel>& objects) {
  SceneLayout layout;
  layout.name = "staged";
  layout.models = models;
  layout.objects = objects;
  layout.workspace = {-0.2, 0.2, -0.15, 0.15};
  const Intrinsics intrinsics{320, 240, 262.5, 262.5, 159.5, 119.5};
  layout.camera = camera_looking_at(intrinsics, {0.0, -0.75, 0.54}, {0.0, 0.0, 0.05});
  return simulate(layout, DepthSensorSettings::clean(), 1).scene;
}

}  // namespace perch
