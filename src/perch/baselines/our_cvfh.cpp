#include "perch/baselines/our_cvfh.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <tuple>

#include "perch/baselines/prepared_scene.hpp"
#include "perch/baselines/upright_pose.hpp"
#include "perch/core/assignment.hpp"
#include "perch/core/error.hpp"
#include "perch/observation/nearest_table.hpp"
#include "perch/refine/surface_views.hpp"
#include "perch/refine/visible_samples.hpp"

namespace perch {

std::filesystem::path default_training_cache() {
  const auto folder = [](const char* variable) {
    const char* value = std::getenv(variable);
    return std::filesystem::path(value == nullptr ? "" : value);
  };
  // A relative path there is to be ignored (XDG Base Directory Specification).
  if (const auto cache = folder("XDG_CACHE_HOME"); cache.is_absolute()) return cache / "perch";
  if (const auto home = folder("HOME"); home.is_absolute()) return home / ".cache" / "perch";
  return {};
}

void OurCvfhSettings::check() const {
  const auto in_range = [](const char* field, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw InvalidSetting(
          fmt::format("ourcvfh.{} is {}; it must lie between {} and {}", field, value, low, high));
  };
  training.check();
  in_range("cluster_tolerance", cluster_tolerance, training.descriptor.voxel, 1.0);
  in_range("least_cluster", least_cluster, 1, 1e6);
  in_range("neighbours", neighbours, 1, 1000);
  in_range("largest_tilt", largest_tilt, 0.0, 3.15);
  refine.check();
}

namespace {

constexpr double icp_reach = 0.03;      // metres
constexpr double fitness_limit = 0.01;  // metres: how far off a point is at most counted

/// 1 - intersection over union of two histograms, in [0, 1] (the distance of PCL's recognition framework).
double distance(const CloudDescriptor& a, const CloudDescriptor& b) {
  using Histogram = Eigen::Map<const Eigen::Array<float, 308, 1>>;
  const Histogram first(a.histogram.data()), second(b.histogram.data());
  const double common = static_cast<double>(first.min(second).sum());
  const double all = static_cast<double>(first.max(second).sum());
  return all > 0.0 ? 1.0 - common / all : 0.0;
}

/// A pose that a cluster's descriptor and a model's imply together.
struct Match {
  double distance = 0.0;
  Pose pose;
};

/// The nearest pairs of descriptors, nearest first, of those that imply an upright pose.
std::vector<Match> nearest_matches(const std::vector<CloudDescriptor>& cluster, const TrainedModel& trained,
                                   const Eigen::Isometry3d& world_from_camera, const ObjectModel& model,
                                   const OurCvfhSettings& settings) {
  struct Pair {
    double distance;
    std::size_t seen, learned;
    auto order() const { return std::tie(distance, seen, learned); }
  };
  std::vector<Pair> pairs;
  pairs.reserve(cluster.size() * trained.size());
  for (std::size_t i = 0; i < cluster.size(); ++i)
    for (std::size_t j = 0; j < trained.size(); ++j)
      if (cluster[i].of_region == trained[j].of_region)
        pairs.push_back({distance(cluster[i], trained[j]), i, j});
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.order() < b.order(); });
  const Eigen::Vector3d middle = model.bounds().center().cast<double>();
  std::vector<Match> matches;
  for (const Pair& pair : pairs) {
    const Eigen::Isometry3d world_from_model(
        (world_from_camera * cluster[pair.seen].frame_from_cloud.inverse() *
         trained[pair.learned].frame_from_cloud)
            .matrix());
    if (tilt(world_from_model) > settings.largest_tilt) continue;
    matches.push_back({pair.distance, upright_pose(world_from_model, middle)});
    if (matches.size() == static_cast<std::size_t>(settings.neighbours)) break;
  }
  return matches;
}

/// ICP on poses, and how well they fit.
class PoseRefinement {
 public:
  PoseRefinement(const PreparedScene& scene, const RefineSettings& settings, const Executor& executor,
                 const StopCondition& stop)
      : scene_(scene),
        settings_(settings),
        reach_(settings.reach.value_or(icp_reach)),
        eye_(scene.observation.camera().world_from_camera.translation()),
        nearest_(scene.observation, reach_, executor, stop) {
    const double away =
        static_cast<double>(0.5F * (scene.observation.nearest() + scene.observation.farthest()));
    for (const ObjectModel& model : scene.models) views_.emplace_back(model, away, settings.samples);
  }

  Pose refined(std::size_t model, Pose pose) const {
    pose = scene_.admitted(model, pose);
    if (settings_.method == RefineMethod::none) return pose;
    for (int round = 0; round < settings_.rounds; ++round) {
      const Pose moved = scene_.admitted(
          model, align(samples(model, pose), pose, scene_.models[model].symmetry().is_continuous(), nearest_,
                       reach_, settings_)
                     .pose);
      if (moved == pose) break;
      pose = moved;
    }
    return pose;
  }

  /// How far the model's visible surface lies from I plus how far the cluster lies from the model's surface,
  /// each as a share of fitness_limit, on average. \param cluster world frame.
  double misfit(std::size_t model, const Pose& pose, const std::vector<Eigen::Vector3f>& cluster) const {
    const ObjectModel& object = scene_.models[model];
    const Eigen::Isometry3f model_from_world = object.world_from_model(pose).inverse().cast<float>();
    double sum = 0.0;
    for (const Eigen::Vector3f& p : cluster) {
      const double off = std::abs(static_cast<double>(object.solid().signed_distance(model_from_world * p)));
      sum += std::min(1.0, off / fitness_limit);
    }
    return mean_residual(samples(model, pose), nearest_, fitness_limit) +
           sum / static_cast<double>(cluster.size());
  }

 private:
  SurfaceSamples samples(std::size_t model, const Pose& pose) const {
    const SurfaceViews::View view = views_[model].from(eye_, pose);
    SurfaceSamples seen;
    Sight sight;
    visible_samples(view.samples, {pose.x, pose.y, view.yaw}, scene_.models[model].origin_z(), nullptr,
                    scene_.observation, settings_.occlusion, seen, sight);
    return seen;
  }

  const PreparedScene& scene_;
  RefineSettings settings_;
  double reach_;
  Eigen::Vector3d eye_;
  NearestTable nearest_;
  std::deque<SurfaceViews> views_;
};

std::vector<TrainedModel> trained_models(const Scene& scene, const OurCvfhSettings& settings,
                                         const Executor& executor, const StopCondition& stop) {
  std::vector<TrainedModel> models;
  for (const SceneModel& model : scene.models)
    models.push_back(trained(model.mesh, settings.training, settings.cache, executor, stop));
  return models;
}

/// A part of I that stands apart from the rest.
struct Cluster {
  std::vector<Eigen::Vector3f> points;  ///< world frame
  std::vector<CloudDescriptor> descriptors;
};

std::vector<Cluster> described_clusters(const Observation& observation, std::size_t count,
                                        const OurCvfhSettings& settings, const Executor& executor,
                                        const StopCondition& stop) {
  const Eigen::Isometry3d& world_from_camera = observation.camera().world_from_camera;
  const Eigen::Vector3d up = world_from_camera.linear().transpose() * Eigen::Vector3d::UnitZ();
  auto found = largest_clusters(observation.points(), count, settings.cluster_tolerance,
                                settings.least_cluster, settings.training.descriptor.voxel);
  std::vector<Cluster> clusters(found.size());
  const auto describe = [&](std::size_t i, std::size_t) {
    clusters[i].descriptors = describe_cloud(found[i], up, settings.training.descriptor);
    for (Eigen::Vector3f& p : found[i]) p = world_from_camera.cast<float>() * p;
    clusters[i].points = std::move(found[i]);
  };
  if (!executor.for_each(clusters.size(), describe, stop)) throw Interrupted();
  return clusters;
}

/// Fills in the answer step by step; throws Interrupted where the clock strikes.
void recognize(const Scene& scene, const OurCvfhSettings& settings, const Executor& executor,
               const StopCondition& stop, BaselineAnswer& answer) {
  const PreparedScene prepared = prepare(scene, executor, stop);
  const std::vector<TrainedModel> learned = trained_models(scene, settings, executor, stop);
  const std::size_t objects = scene.objects.size();
  const std::vector<Cluster> clusters =
      described_clusters(prepared.observation, objects, settings, executor, stop);

  // Of each model (row) and cluster (column), row-major.
  std::vector<std::vector<Match>> matches(prepared.models.size() * clusters.size());
  const auto match = [&](std::size_t i, std::size_t) {
    const std::size_t model = i / clusters.size(), cluster = i % clusters.size();
    matches[i] = nearest_matches(clusters[cluster].descriptors, learned[model],
                                 scene.camera.world_from_camera, prepared.models[model], settings);
  };
  if (!executor.for_each(matches.size(), match, stop)) throw Interrupted();
  const auto matches_of = [&](std::size_t object, std::size_t cluster) -> const std::vector<Match>& {
    return matches[prepared.of_object[object] * clusters.size() + cluster];
  };
  constexpr double no_match = 2.0;  // more than any distance
  Eigen::MatrixXd costs(objects, clusters.size());
  for (std::size_t o = 0; o < objects; ++o)
    for (std::size_t c = 0; c < clusters.size(); ++c)
      costs(static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(c)) =
          matches_of(o, c).empty() ? no_match : matches_of(o, c).front().distance;
  const auto assigned = min_cost_assignment(costs);

  struct Hypothesis {
    std::size_t object, cluster;
    Pose pose;
    double misfit = 0.0;
  };
  std::vector<Hypothesis> hypotheses;
  for (std::size_t o = 0; o < objects; ++o) {
    if (!assigned[o]) continue;
    for (const Match& m : matches_of(o, *assigned[o])) hypotheses.push_back({o, *assigned[o], m.pose});
    if (!matches_of(o, *assigned[o]).empty()) answer.poses[o] = matches_of(o, *assigned[o]).front().pose;
  }
  const PoseRefinement refinement(prepared, settings.refine, executor, stop);
  const auto refine = [&](std::size_t i, std::size_t) {
    Hypothesis& h = hypotheses[i];
    const std::size_t model = prepared.of_object[h.object];
    h.pose = refinement.refined(model, h.pose);
    h.misfit = refinement.misfit(model, h.pose, clusters[h.cluster].points);
  };
  if (!executor.for_each(hypotheses.size(), refine, stop)) throw Interrupted();
  answer.hypotheses = static_cast<std::int64_t>(hypotheses.size());
  std::vector<const Hypothesis*> best(objects, nullptr);
  for (const Hypothesis& h : hypotheses)
    if (best[h.object] == nullptr || h.misfit < best[h.object]->misfit) best[h.object] = &h;
  for (std::size_t o = 0; o < objects; ++o)
    if (best[o] != nullptr) answer.poses[o] = best[o]->pose;
}

}  // namespace

BaselineAnswer our_cvfh(const Scene& scene, const OurCvfhSettings& settings, const Executor& executor,
                        const StopCondition& stop) {
  settings.check();
  BaselineAnswer answer;
  answer.poses.resize(scene.objects.size());
  try {
    recognize(scene, settings, executor, stop, answer);
  } catch (const Interrupted&) {
    answer.stopped = true;
  }
  return answer;
}

void train_our_cvfh(const Scene& scene, const OurCvfhSettings& settings, const Executor& executor,
                    const StopCondition& stop) {
  settings.check();
  trained_models(scene, settings, executor, stop);
}

}  // namespace perch
