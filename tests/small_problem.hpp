#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "perch/candidates/first_scenes.hpp"
#include "perch/candidates/fixed_candidates.hpp"
#include "perch/core/random.hpp"
#include "perch/localize/setup.hpp"
#include "perch/sim/scene_generator.hpp"
#include "perch/tree/scene_tree.hpp"

namespace perch {

/// A random scene of few pixels and objects.
inline SimulatedScene small_tabletop(std::uint64_t seed, bool noise, int objects, bool repeats,
                                     bool optional = false) {
  TabletopOptions options;
  options.min_objects = options.max_objects = objects;
  options.noise = noise;
  options.width = 80;
  options.height = 60;
  options.least_visible = 0.05;
  if (repeats) options.models = {"can"};
  SimulatedScene simulated = random_tabletop(seed, options);
  simulated.scene.objects.back().optional = optional;
  return simulated;
}

/// The same scene with some models that may rest in several ways, and some of their objects lying or standing
/// on their heads; seen anew by an ideal camera.
inline SimulatedScene with_rest_poses(const SimulatedScene& upright, std::uint64_t seed) {
  Random random(seed);
  const Scene& scene = upright.scene;
  SceneLayout layout{scene.name, scene.camera, {}, {}, *scene.workspace};
  std::vector<std::size_t> first;  // bodies, of each model
  for (const SceneModel& model : scene.models) {
    std::vector<Eigen::Vector3d> ups{Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(),
                                     -Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitZ()};
    std::swap(ups[0], ups[random.below(ups.size())]);
    std::swap(ups[1], ups[1 + random.below(ups.size() - 1)]);
    ups.resize(1 + random.below(3));
    if (random.below(2) == 0)
      ups[0] = Eigen::Vector3d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), 0.3).normalized();
    first.push_back(layout.models.size());
    for (SceneModel& body : bodies_of(model, ups)) layout.models.push_back(std::move(body));
  }
  for (const TruthPose& truth : scene.truth) {
    const std::size_t bodies = rest_pose_count(layout.models, first[truth.model]);
    layout.objects.push_back({first[truth.model] + random.below(bodies), truth.pose});
  }
  SimulatedScene made = simulate(layout, DepthSensorSettings::clean(), seed);
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    made.scene.objects[i].optional = scene.objects[i].optional;
  return made;
}

/// A mask that leaves out a few pixels; those without a reading are unknown then.
inline void add_mask(Scene& scene, Random& random) {
  scene.mask = Image<std::uint8_t>(scene.depth.width(), scene.depth.height());
  for (std::size_t i = 0; i < scene.depth.size(); ++i) (*scene.mask)[i] = random.below(20) > 0;
}

/// In two of three cases something stands in the scene that is not looked for, and costs are those of scenes
/// with clutter, either way.
inline void add_clutter(Scene& scene, Settings& settings, Random& random) {
  const std::uint64_t kind = random.below(3);
  settings.candidates.cost.clutter_weight = random.uniform(1.0 / 64.0, 1.0);
  if (kind == 0) return;
  scene.clutter = true;
  if (scene.objects.size() > 2) scene.objects.erase(scene.objects.begin());
  if (kind == 1) return;
  settings.candidates.cost.clutter_points = ClutterPoints::ignore;
  for (SceneObject& object : scene.objects) object.optional = false;
}

/// A grid of few poses.
inline Settings small_settings(RefineMethod refine) {
  Settings settings;
  settings.candidates.grid.resolution = 0.14;
  settings.candidates.grid.yaw_resolution = 1.6;
  settings.candidates.cost.delta = 0.008;
  settings.candidates.refine.method = refine;
  settings.candidates.refine.reach = 0.05;
  settings.tree.pixel_tolerance = 2;
  settings.polish.rounds = 0;  // the answers compared are those of the searches
  settings.ambiguity.trials = 0;
  return settings;
}

/// A scene small enough that every arrangement of its candidates can be tried.
struct SmallProblem {
  SimulatedScene simulated;
  Settings settings;
  SerialExecutor executor;
  std::unique_ptr<LocalizationProblem> problem;
  std::vector<CandidateMaker> makers;
  std::optional<FixedCandidates> refined;  ///< all hypotheses, none valued; copies of it can be
  CandidateSet set;                        ///< all of them valued

  SmallProblem(std::uint64_t seed, bool noise, RefineMethod refine, int objects = 3, bool repeats = false,
               bool optional = false)
      : SmallProblem(small_tabletop(seed, noise, objects, repeats, optional), small_settings(refine)) {}
  SmallProblem(SimulatedScene scene, const Settings& with) : simulated(std::move(scene)), settings(with) {
    problem = make_problem(simulated.scene, settings, executor);
    makers = make_makers(*problem, executor);
    refined.emplace(*problem, makers, executor);
    refined->refine(StopCondition());
    FixedCandidates all = *refined;
    all.value_all(StopCondition());
    set = std::move(all.set());
    // Enumeration asks for each rendering very often, also for those that explain nothing.
    for (CandidateId id = 0; id < set.size(); ++id) {
      const DepthPatch patch = makers.front().patch(set[id]);
      set[id].patch = patch;
    }
  }
  SmallProblem(const SmallProblem&) = delete;  // what is refined refers to the others
  SmallProblem& operator=(const SmallProblem&) = delete;

  std::int64_t flat_cost(const std::vector<CandidateId>& placed) {
    Composite composite = problem->cost().empty();
    for (const CandidateId id : placed)
      problem->cost().add(composite, makers.front().patch(set[id]), makers.front().scratch());
    return problem->cost().counts(composite).total();
  }

  bool collision_free(const std::vector<CandidateId>& placed) const {
    for (std::size_t i = 0; i < placed.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (problem->collide(set[placed[i]], set[placed[j]])) return false;
    return true;
  }

  /// Calls `visit` with every multiset of candidates that has one for each object, ascending numbers.
  template <typename Visit>
  void for_each_scene(Visit visit) const {
    std::vector<CandidateId> placed;
    std::vector<int> left = problem->copies();
    extend(0, 0, placed, left, visit);
  }

 private:
  template <typename Visit>
  void extend(std::size_t kind, std::size_t first, std::vector<CandidateId>& placed, std::vector<int>& left,
              Visit& visit) const {
    while (kind < left.size() && left[kind] == 0) {
      ++kind;
      first = 0;
    }
    if (kind == left.size()) {
      std::vector<CandidateId> sorted = placed;
      std::sort(sorted.begin(), sorted.end());
      visit(sorted);
      return;
    }
    const auto& ids = set.of_kind(kind);
    for (std::size_t i = first; i < ids.size(); ++i) {
      placed.push_back(ids[i]);
      --left[kind];
      extend(kind, i, placed, left, visit);
      ++left[kind];
      placed.pop_back();
    }
  }
};

constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();

/// What enumeration finds, each cost counted anew.
struct Enumerated {
  std::vector<CandidateScene> scenes;  ///< free of collisions
  std::int64_t best = none;
  std::int64_t best_in_tree = none;  ///< of those with a monotone order
};

inline SceneTree tree_of(SmallProblem& small) {
  return SceneTree::fixed(*small.problem, small.set, small.makers, small.executor, small.settings.tree);
}

inline Enumerated enumerate(SmallProblem& small) {
  const SceneTree tree = tree_of(small);
  Enumerated result;
  small.for_each_scene([&](const std::vector<CandidateId>& placed) {
    if (!small.collision_free(placed)) return;
    const std::int64_t cost = small.flat_cost(placed);
    result.scenes.push_back({placed, cost});
    result.best = std::min(result.best, cost);
    if (cost < result.best_in_tree && tree.contains(placed)) result.best_in_tree = cost;
  });
  return result;
}

}  // namespace perch
