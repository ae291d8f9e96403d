#include "perch/verify/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "perch/core/error.hpp"
#include "perch/verify/certificate.hpp"
#include "perch/verify/cost_range.hpp"
#include "perch/verify/scene_view.hpp"
#include "perch/verify/solid.hpp"

namespace perch {
namespace {

std::string text(const std::optional<std::int64_t>& count) {
  return count ? fmt::format("{}", *count) : "null";
}

/// World height of the support plane: the scene's, or that below which one observed point in 200 lies.
double support_height(const Scene& scene, const ObservedPoints& observed) {
  if (scene.table_height) return *scene.table_height;
  std::vector<double> heights;
  for (const Eigen::Vector3d& p : observed.points())
    heights.push_back((scene.camera.world_from_camera * p).z());
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 200);
  std::nth_element(heights.begin(), low, heights.end());
  return *low;
}

class Verification {
 public:
  Verification(const Scene& scene, const ReportedResult& result, const Settings& settings)
      : scene_(scene),
        result_(result),
        settings_(settings),
        observed_(scene.camera, scene.depth, scene.mask),
        camera_from_world_(scene.camera.world_from_camera.inverse()) {
    if (observed_.points().empty())
      throw InputError("no observed points; check observation.depth and observation.mask");
    height_ = support_height(scene, observed_);
  }

  Checks run() {
    check_certificate(scene_, result_, checks_);
    const auto points = static_cast<std::int64_t>(observed_.points().size());
    add("observed_points", fmt::format("{}", result_.observed_points), fmt::format("{}", points),
        result_.observed_points == points);
    std::vector<PlacedModel> placed;
    for (const ReportedObject& object : result_.objects)
      if (!object.absent) placed.push_back({object.model, object.pose});
    // What places more objects than the scene has is wrong already, and might take for ever.
    const std::size_t most = scene_.objects.size();
    if ((result_.cost || !placed.empty()) && placed.size() <= most) check_objects(placed);
    if ((result_.search_cost || !result_.search_objects.empty()) && result_.search_objects.size() <= most)
      check_searched(placed);
    return std::move(checks_);
  }

 private:
  void add(const std::string& what, std::string reported, std::string recomputed, bool holds) {
    checks_.push_back({what, std::move(reported), std::move(recomputed), holds});
  }
  void add_count(const std::string& what, const std::optional<std::int64_t>& reported,
                 const CountRange& range) {
    add(what, text(reported), range.text(), reported && range.contains(*reported));
  }

  /// Of the mesh as it stands.
  Eigen::Isometry3d world_from_model(const PlacedModel& placed) const {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(Eigen::Vector3d(placed.pose.x, placed.pose.y, height_ + scene_.models[placed.model].base));
    pose.rotate(Eigen::AngleAxisd(placed.pose.yaw, Eigen::Vector3d::UnitZ()));
    return pose;
  }

  /// What is seen of the `number`-th object of a scene when it stands alone.
  std::vector<Sighting> sightings_of(const PlacedModel& placed, std::uint32_t number) const {
    return sightings(scene_.models[placed.model].mesh, camera_from_world_ * world_from_model(placed),
                     scene_.camera.intrinsics, number);
  }
  using EachSighting = std::vector<std::vector<Sighting>>;
  EachSighting each_of(const std::vector<PlacedModel>& placed) const {
    EachSighting each;
    for (const PlacedModel& object : placed)
      each.push_back(sightings_of(object, static_cast<std::uint32_t>(each.size())));
    return each;
  }
  static SceneView view_of(const EachSighting& each) {
    std::vector<Sighting> all;
    for (const auto& seen : each) all.insert(all.end(), seen.begin(), seen.end());
    return {std::move(all), each.size()};
  }

  CostRange cost_of(const SceneView& view) const {
    const CostSettings& cost = settings_.candidates.cost;
    CountingRule rule{cost.delta,
                      cost.missing_depth == MissingDepth::ignore,
                      scene_.clutter && cost.clutter_points == ClutterPoints::ignore,
                      {}};
    if (scene_.clutter) rule.clutter_weight = cost.clutter_weight;
    return cost_range(observed_, scene_.camera.intrinsics, view, rule);
  }

  void check_objects(const std::vector<PlacedModel>& placed) {
    EachSighting each = each_of(placed);
    const SceneView view = view_of(each);
    const CostRange cost = cost_of(view);
    searched_cost_ = cost.total();
    add_count("cost", result_.cost, cost.total());
    add_count("cost_observed", result_.cost_observed, cost.observed);
    add_count("cost_rendered", result_.cost_rendered, cost.rendered);
    std::size_t next = 0;
    for (std::size_t i = 0; i < result_.objects.size(); ++i) {
      if (result_.objects[i].absent) continue;
      check_object(fmt::format("objects[{}].", i), result_.objects[i], placed[next], view.visible()[next],
                   view.alone()[next], cost.explained[next]);
      check_other_poses(fmt::format("objects[{}].", i), result_.objects[i], each, next);
      ++next;
    }
    // A method without a bound promises no collision-free scene.
    if (result_.has_bound()) check_collisions("objects", placed);
  }

  void check_object(const std::string& prefix, const ReportedObject& object, const PlacedModel& placed,
                    const CountRange& visible, const CountRange& alone, const CountRange& explained) {
    // What is stated is of the model's own frame.
    const Eigen::Isometry3d pose = world_from_model(placed) * scene_.models[placed.model].stood_from_model;
    check_matrix(prefix + "world_from_model", object.world_from_model, pose);
    check_matrix(prefix + "camera_from_model", object.camera_from_model, camera_from_world_ * pose);
    add_count(prefix + "visible_pixels", object.visible_pixels, visible);
    const double pixels = static_cast<double>(object.visible_pixels);
    // Both fractions are of counts. Of the one that isn't reported, the nearest that can be meant is looked
    // at.
    check_fraction(prefix + "visible_fraction", object.visible_fraction, "visible_pixels / {}", alone,
                   object.visible_fraction > 0.0 ? pixels / object.visible_fraction : 0.0,
                   [&](double whole) { return whole > 0.0 ? pixels / whole : 0.0; });
    check_fraction(prefix + "explained_fraction", object.explained_fraction, "{} / visible_pixels", explained,
                   object.explained_fraction * pixels,
                   [&](double part) { return pixels > 0.0 ? part / pixels : 0.0; });
  }

  /// \param each sightings of all objects; the same on return. \param number of this object among them.
  void check_other_poses(const std::string& prefix, const ReportedObject& object, EachSighting& each,
                         std::size_t number) {
    if (object.confidence)
      add(prefix + "confidence", fmt::format("{}", *object.confidence), "from 0 to 1",
          *object.confidence >= 0.0 && *object.confidence <= 1.0);
    if (!object.runner_up || !result_.cost) return;
    const std::size_t body =
        scene_.kind(object.model) + static_cast<std::size_t>(object.runner_up->rest_pose.value_or(0));
    std::vector<Sighting> elsewhere =
        sightings_of({body, object.runner_up->pose}, static_cast<std::uint32_t>(number));
    elsewhere.swap(each[number]);
    const CountRange cost = cost_of(view_of(each)).total();
    elsewhere.swap(each[number]);
    add_count(prefix + "runner_up.cost_increase", object.runner_up->cost_increase,
              {cost.low - *result_.cost, cost.high - *result_.cost});
  }

  /// \param meant the count that the fraction stands for, before it is made whole. \param fraction_of the
  /// fraction of a count.
  template <typename FractionOf>
  void check_fraction(const std::string& what, double reported, const std::string& formula,
                      const CountRange& range, double meant, FractionOf fraction_of) {
    constexpr double rounding = 1e-12;
    bool holds = false;
    // Where nothing is visible, every count gives the same fraction.
    const auto nearest = static_cast<double>(std::clamp<std::int64_t>(
        meant < 1e15 && meant > -1e15 ? std::llround(meant) : 0, range.low, range.high));
    holds = std::abs(fraction_of(nearest) - reported) <= rounding;
    add(what, fmt::format("{:.9g}", reported), fmt::format(fmt::runtime(formula), range.text()), holds);
  }

  void check_matrix(const std::string& what, const Eigen::Matrix4d& reported, const Eigen::Isometry3d& pose) {
    // An estimated height is a depth in single precision, turned into the world.
    const double tolerance = scene_.table_height ? 1e-9 : 1e-6;
    const double difference = (reported - pose.matrix()).cwiseAbs().maxCoeff();
    add(what, "a matrix", fmt::format("differs by {:.1e}", difference), difference <= tolerance);
  }

  void check_searched(const std::vector<PlacedModel>& placed) {
    if (!searched_cost_ || !same(placed, result_.search_objects)) {
      searched_cost_ = cost_of(view_of(each_of(result_.search_objects))).total();
      check_collisions("search_objects", result_.search_objects);
    }
    add_count("search_cost", result_.search_cost, *searched_cost_);
  }

  /// The smallest box along the world's axes that holds an object.
  Eigen::AlignedBox3d bounds_of(const PlacedModel& placed) const {
    const Eigen::Isometry3d pose = world_from_model(placed);
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3f& p : scene_.models[placed.model].mesh.vertices)
      box.extend(pose * p.cast<double>());
    return box;
  }

  static bool same(const std::vector<PlacedModel>& a, const std::vector<PlacedModel>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const PlacedModel& p, const PlacedModel& q) {
      return p.model == q.model && p.pose == q.pose;
    });
  }

  const Solid& solid_of(std::size_t model) {
    const auto found = solids_.find(model);
    if (found != solids_.end()) return found->second;
    return solids_.try_emplace(model, scene_.models[model].mesh).first->second;
  }

  void check_collisions(const std::string& list, const std::vector<PlacedModel>& placed) {
    const double penetration = settings_.candidates.collision.penetration,
                 share = settings_.candidates.collision.overlap;
    std::vector<Eigen::AlignedBox3d> bounds;
    for (const PlacedModel& object : placed) bounds.push_back(bounds_of(object));
    Overlap most;
    constexpr std::size_t most_named = 20;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < placed.size(); ++i)
      for (std::size_t j = 0; j < i && wrong < most_named; ++j) {
        if (!bounds[i].intersects(bounds[j])) continue;
        const PlacedSolid a{&solid_of(placed[i].model), world_from_model(placed[i])},
            b{&solid_of(placed[j].model), world_from_model(placed[j])};
        const Overlap found = overlap_of(a, b);
        most = {std::max(most.depth, found.depth), std::max(most.share, found.share)};
        const double deepest = penetration + depth_slack(*a.solid, *b.solid);
        if (found.depth <= deepest && found.share <= share + share_slack) continue;
        ++wrong;
        add(fmt::format("{}[{}] and [{}] don't collide", list, j, i), "apart",
            fmt::format("{:.1f} mm deep (at most {:.1f}), share {:.2f} (at most {:.2f})",
                        1000.0 * found.depth, 1000.0 * deepest, found.share, share + share_slack),
            false);
      }
    if (wrong == 0)
      add(fmt::format("{} don't collide", list), "apart",
          fmt::format("{:.1f} mm deep, share {:.2f}", 1000.0 * most.depth, most.share), true);
  }

  const Scene& scene_;
  const ReportedResult& result_;
  const Settings& settings_;
  ObservedPoints observed_;
  Eigen::Isometry3d camera_from_world_;
  double height_ = 0.0;
  std::map<std::size_t, Solid> solids_;
  std::optional<CountRange> searched_cost_;
  Checks checks_;
};

}  // namespace

Settings stated_settings(const Guarantee& guarantee) {
  Settings settings;
  set_field(settings, "cost.missing_depth", guarantee.missing_depth);
  if (guarantee.clutter) set_field(settings, "cost.clutter_points", guarantee.clutter->points);
  settings.candidates.cost.delta = guarantee.delta;
  if (guarantee.clutter) settings.candidates.cost.clutter_weight = guarantee.clutter->weight;
  settings.candidates.collision.penetration = guarantee.collision_penetration;
  settings.candidates.collision.overlap = guarantee.collision_overlap;
  settings.check();
  return settings;
}

Checks verify(const Scene& scene, const ReportedResult& result, const Settings& settings) {
  return Verification(scene, result, settings).run();
}

}  // namespace perch
