#include "perch/baselines/ppf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/surface_matching/ppf_match_3d.hpp>
#include <tuple>

#include "perch/baselines/joint_selection.hpp"
#include "perch/baselines/model_cloud.hpp"
#include "perch/baselines/observed_surface.hpp"
#include "perch/core/error.hpp"

namespace perch {
namespace {

/// An upright pose with the votes of all scene points that proposed about the same.
struct VotedPose {
  Pose pose;
  std::size_t votes = 0;
};

cv::Mat matrix_of(const SurfaceSamples& samples) {
  cv::Mat matrix(static_cast<int>(samples.size()), 6, CV_32F);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    auto* row = matrix.ptr<float>(static_cast<int>(i));
    const Eigen::Vector3f p = samples.point(i), n = samples.normal(i);
    for (int k = 0; k < 3; ++k) {
      row[k] = p[k];
      row[k + 3] = n[k];
    }
  }
  return matrix;
}

/// The side of the smallest box along the axes that holds the points, its longest, metres.
float extent_of(const SurfaceSamples& samples) {
  float most = 0.0F;
  for (const auto* values : {&samples.x, &samples.y, &samples.z}) {
    const auto [low, high] = std::minmax_element(values->begin(), values->end());
    most = std::max(most, *high - *low);
  }
  return most;
}

class PairFeatures {
 public:
  PairFeatures(const PreparedScene& scene, const SurfaceSamples& observed, const PpfSettings& settings)
      : scene_(scene), observed_(observed), settings_(settings) {}

  /// Distinct upright poses of a model, those with the most votes first.
  std::vector<VotedPose> propose(std::size_t model) const {
    const ObjectModel& object = scene_.models[model];
    const float spacing = static_cast<float>(settings_.sampling_step) * object.bounds().sizes().norm();
    constexpr std::size_t dense = 30'000;
    const SurfaceSamples surface = thinned(model_cloud(object.mesh(), dense), spacing);
    const SurfaceSamples cloud = thinned(observed_, spacing);
    if (surface.size() < 2 || cloud.size() < 2) return {};
    cv::ppf_match_3d::PPF3DDetector detector(settings_.sampling_step, settings_.sampling_step,
                                             settings_.angles);
    detector.trainModel(matrix_of(surface));
    // Poses are not averaged: OpenCV compares rotations by their angles alone, whatever the axes.
    constexpr double apart = 1e-9;
    detector.setSearchParams(apart, apart);
    // The scene has been thinned already: a grid this fine leaves it nearly as it is.
    constexpr double finest = 1.0 / 150.0;
    const double grid = std::clamp(static_cast<double>(0.5F * spacing / extent_of(cloud)), finest, 0.1);
    std::vector<cv::ppf_match_3d::Pose3DPtr> results;
    // OpenCV takes the whole part of the share's reciprocal; the quarter keeps rounding away from it.
    detector.match(matrix_of(cloud), results, 1.0 / (settings_.reference_step + 0.25), grid);
    std::vector<VotedPose> poses;
    for (const auto& result : results) {
      const auto pose = upright(model, result->pose);
      if (pose) poses.push_back({*pose, result->numVotes});
    }
    return distinct(model, std::move(poses));
  }

 private:
  /// The pose projected to (x, y, yaw), if it is nearly one.
  std::optional<Pose> upright(std::size_t model, const cv::Matx44d& found) const {
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) rotation(i, j) = found(i, j);
      translation[i] = found(i, 3);
    }
    if (!rotation.allFinite() || !translation.allFinite()) return std::nullopt;
    const ObjectModel& object = scene_.models[model];
    const Eigen::Vector3d middle = object.bounds().center().cast<double>();
    const Eigen::Vector3d there = rotation * middle + translation;
    if (rotation(2, 2) < std::cos(settings_.greatest_tilt)) return std::nullopt;
    if (std::abs(there.z() - middle.z() - object.origin_z()) > settings_.greatest_lift) return std::nullopt;
    // The rotation about z nearest to it; the model's middle stays where it is.
    const double yaw = std::atan2(rotation(1, 0) - rotation(0, 1), rotation(0, 0) + rotation(1, 1));
    const Eigen::Vector3d origin = there - Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * middle;
    return scene_.admitted(model, {origin.x(), origin.y(), yaw});
  }

  std::vector<VotedPose> distinct(std::size_t model, std::vector<VotedPose> poses) const {
    constexpr double same_place = 0.01, same_yaw = 10.0 * std::numbers::pi / 180.0;
    std::sort(poses.begin(), poses.end(), [](const VotedPose& a, const VotedPose& b) {
      return std::tuple(b.votes, a.pose.x, a.pose.y, a.pose.yaw) <
             std::tuple(a.votes, b.pose.x, b.pose.y, b.pose.yaw);
    });
    const Symmetry& symmetry = scene_.models[model].symmetry();
    std::vector<VotedPose> kept;
    for (const VotedPose& pose : poses) {
      const auto same = std::find_if(kept.begin(), kept.end(), [&](const VotedPose& other) {
        return std::hypot(pose.pose.x - other.pose.x, pose.pose.y - other.pose.y) < same_place &&
               symmetry.yaw_difference(pose.pose.yaw, other.pose.yaw) < same_yaw;
      });
      if (same == kept.end())
        kept.push_back(pose);
      else
        same->votes += pose.votes;
    }
    std::stable_sort(kept.begin(), kept.end(),
                     [](const VotedPose& a, const VotedPose& b) { return a.votes > b.votes; });
    kept.resize(std::min(kept.size(), static_cast<std::size_t>(settings_.proposals)));
    return kept;
  }

  const PreparedScene& scene_;
  const SurfaceSamples& observed_;
  const PpfSettings& settings_;
};

}  // namespace

void PpfSettings::check() const {
  const auto in_range = [](const char* field, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw InvalidSetting(
          fmt::format("ppf.{} is {}; it must lie between {} and {}", field, value, low, high));
  };
  in_range("sampling_step", sampling_step, 0.01, 0.5);
  in_range("reference_step", reference_step, 1, 1000);
  in_range("angles", angles, 4, 360);
  in_range("normal_radius", normal_radius, 1e-4, 1.0);
  in_range("greatest_tilt", greatest_tilt, 0.0, std::numbers::pi);
  in_range("greatest_lift", greatest_lift, 0.0, 100.0);
  in_range("proposals", proposals, 1, 1e6);
  refine.check();
  cost.check();
  collision.check();
}

BaselineAnswer ppf(const Scene& scene, const PpfSettings& settings, const Executor& executor,
                   const StopCondition& stop) {
  settings.check();
  const PreparedScene prepared = prepare(scene, executor, stop);
  const SurfaceSamples observed =
      observed_surface(prepared.observation, settings.normal_radius, executor, stop);
  const DeltaIndex index(prepared.observation, settings.cost.delta, executor, stop);
  const ExplanationCost cost(prepared.observation, index, settings.cost);
  const PoseAligner aligner(prepared, settings.refine, executor, stop);

  BaselineAnswer answer;
  const PairFeatures features(prepared, observed, settings);
  std::vector<std::vector<VotedPose>> of_model(prepared.models.size());
  answer.stopped = !executor.for_each(
      of_model.size(),
      [&](std::size_t model, std::size_t) {
        if (prepared.copies[model] > 0) of_model[model] = features.propose(model);
      },
      stop);
  std::vector<ProposedPose> proposed;
  for (std::size_t model = 0; model < of_model.size(); ++model)
    for (const VotedPose& pose : of_model[model]) proposed.push_back({model, pose.pose});
  answer.stopped |= !executor.for_each(
      proposed.size(),
      [&](std::size_t i, std::size_t) {
        proposed[i].pose = aligner.align(proposed[i].model, proposed[i].pose, nullptr);
      },
      stop);
  answer.hypotheses = static_cast<std::int64_t>(proposed.size());
  const JointSelection selection =
      select_jointly(prepared, cost, settings.collision, aligner, proposed, executor, stop);
  answer.poses = selection.poses;
  answer.stopped |= !selection.complete;
  return answer;
}

}  // namespace perch
