#include "perch/baselines/joint_selection.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "perch/render/rasterizer.hpp"

namespace perch {
namespace {

constexpr std::size_t starts = 8;  // first choices of the greedy scenes
constexpr int most_rounds = 20;    // of exchanges: each lowers J, few are needed
constexpr std::int64_t no_cost = std::numeric_limits<std::int64_t>::max();

/// A pose that may be taken, as rendered.
struct Option {
  ProposedPose proposed;
  DepthPatch patch;
};

/// Options that stand together.
struct Arrangement {
  std::vector<Option> options;
  std::int64_t cost = no_cost;
};

class Selection {
 public:
  Selection(const PreparedScene& scene, const ExplanationCost& cost, const CollisionSettings& collision,
            const PoseAligner& aligner, const Executor& executor, const StopCondition& stop)
      : scene_(scene),
        cost_(cost),
        collision_(collision),
        aligner_(aligner),
        executor_(executor),
        stop_(stop),
        camera_from_world_(scene.observation.camera().world_from_camera.inverse()),
        rasterizers_(executor.workers(), Rasterizer(scene.observation.intrinsics())),
        lone_costs_(executor.workers(), LoneCost(cost)) {}

  JointSelection run(const std::vector<ProposedPose>& proposed) {
    options_.resize(proposed.size());
    complete_ = executor_.for_each(
        proposed.size(), [&](std::size_t i, std::size_t worker) { options_[i] = drawn(proposed[i], worker); },
        stop_);
    std::erase_if(options_, [](const Option& option) { return !option.patch.any(); });
    Arrangement best;
    const std::vector<std::int64_t> alone = costs_with(cost_.empty());
    for (const std::size_t first : ascending(alone, starts)) {
      Arrangement arrangement = greedy(first);
      improve(arrangement);
      if (arrangement.options.size() > best.options.size() || arrangement.cost < best.cost)
        best = std::move(arrangement);
      if (!complete_) break;
    }
    align_together(best);
    return selection_of(best);
  }

 private:
  Option drawn(const ProposedPose& proposed, std::size_t worker) {
    Option option{proposed, {}};
    const ObjectModel& model = scene_.models[proposed.model];
    rasterizers_[worker].render(model.mesh(), camera_from_world_ * model.world_from_model(proposed.pose),
                                option.patch);
    return option;
  }

  Composite composite_of(const Arrangement& arrangement, std::optional<std::size_t> without = std::nullopt) {
    Composite composite = cost_.empty();
    for (std::size_t i = 0; i < arrangement.options.size(); ++i)
      if (i != without) lone_costs_.front().add(composite, arrangement.options[i].patch);
    return composite;
  }

  /// J with each of the options added to a composite; no_cost where the clock struck.
  std::vector<std::int64_t> costs_with(const Composite& composite,
                                       std::optional<std::size_t> model = std::nullopt) {
    std::vector<std::int64_t> costs(options_.size(), no_cost);
    constexpr std::size_t batch = 8;
    complete_ &=
        for_each_batched(executor_, options_.size(), batch, stop_, [&](std::size_t i, std::size_t worker) {
          if (model && options_[i].proposed.model != *model) return;
          costs[i] = lone_costs_[worker].counts_with(composite, options_[i].patch, no_cost)->total();
        });
    return costs;
  }

  /// The places of the lowest costs, the lowest first.
  static std::vector<std::size_t> ascending(const std::vector<std::int64_t>& costs, std::size_t most) {
    std::vector<std::size_t> order(costs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return costs[a] < costs[b]; });
    order.resize(std::min(order.size(), most));
    return order;
  }

  bool fits(const ProposedPose& proposed, const Arrangement& arrangement,
            std::optional<std::size_t> without = std::nullopt) const {
    for (std::size_t i = 0; i < arrangement.options.size(); ++i) {
      const ProposedPose& other = arrangement.options[i].proposed;
      if (i != without && scene_.collide(proposed.model, proposed.pose, other.model, other.pose, collision_))
        return false;
    }
    return true;
  }

  Arrangement greedy(std::size_t first) {
    std::vector<int> left = scene_.copies;
    Arrangement arrangement;
    std::optional<std::size_t> next = first;
    while (next) {
      arrangement.options.push_back(options_[*next]);
      --left[options_[*next].proposed.model];
      const std::vector<std::int64_t> costs = costs_with(composite_of(arrangement));
      next.reset();
      for (const std::size_t i : ascending(costs, costs.size()))
        if (costs[i] < no_cost && left[options_[i].proposed.model] > 0 &&
            fits(options_[i].proposed, arrangement)) {
          next = i;
          break;
        }
    }
    arrangement.cost = cost_.counts(composite_of(arrangement)).total();
    return arrangement;
  }

  /// Exchanges one option at a time for the best of its model, while J falls.
  void improve(Arrangement& arrangement) {
    for (int round = 0; round < most_rounds; ++round) {
      const std::int64_t before = arrangement.cost;
      for (std::size_t place = 0; place < arrangement.options.size() && complete_; ++place) {
        const std::vector<std::int64_t> costs =
            costs_with(composite_of(arrangement, place), arrangement.options[place].proposed.model);
        for (const std::size_t i : ascending(costs, costs.size())) {
          if (costs[i] >= arrangement.cost) break;
          if (!fits(options_[i].proposed, arrangement, place)) continue;
          arrangement.options[place] = options_[i];
          arrangement.cost = costs[i];
          break;
        }
      }
      if (arrangement.cost == before || !complete_) return;
    }
  }

  void align_together(Arrangement& arrangement) {
    for (int round = 0; round < most_rounds; ++round) {
      const std::int64_t before = arrangement.cost;
      for (std::size_t place = 0; place < arrangement.options.size() && !stop_(); ++place) {
        const Composite others = composite_of(arrangement, place);
        ProposedPose moved = arrangement.options[place].proposed;
        moved.pose = aligner_.align(moved.model, moved.pose, &others.depth);
        Option option = drawn(moved, 0);
        const auto counts = lone_costs_.front().counts_with(others, option.patch, no_cost);
        if (counts->total() >= arrangement.cost || !fits(moved, arrangement, place)) continue;
        arrangement.options[place] = std::move(option);
        arrangement.cost = counts->total();
      }
      if (arrangement.cost == before) return;
    }
  }

  JointSelection selection_of(const Arrangement& arrangement) const {
    JointSelection selection;
    selection.cost = arrangement.cost;
    selection.complete = complete_;
    std::vector<bool> given(arrangement.options.size(), false);
    for (const std::size_t model : scene_.of_object) {
      auto& pose = selection.poses.emplace_back();
      for (std::size_t i = 0; i < given.size() && !pose; ++i) {
        if (given[i] || arrangement.options[i].proposed.model != model) continue;
        pose = arrangement.options[i].proposed.pose;
        given[i] = true;
      }
    }
    return selection;
  }

  const PreparedScene& scene_;
  const ExplanationCost& cost_;
  const CollisionSettings& collision_;
  const PoseAligner& aligner_;
  const Executor& executor_;
  const StopCondition& stop_;
  Eigen::Isometry3d camera_from_world_;
  std::vector<Rasterizer> rasterizers_;  ///< one a worker
  std::vector<LoneCost> lone_costs_;     ///< one a worker
  std::vector<Option> options_;
  bool complete_ = true;
};

}  // namespace

JointSelection select_jointly(const PreparedScene& scene, const ExplanationCost& cost,
                              const CollisionSettings& collision, const PoseAligner& aligner,
                              const std::vector<ProposedPose>& proposed, const Executor& executor,
                              const StopCondition& stop) {
  return Selection(scene, cost, collision, aligner, executor, stop).run(proposed);
}

}  // namespace perch
