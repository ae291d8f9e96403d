#include "bop_errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "perch/core/assignment.hpp"
#include "perch/eval/pose_errors.hpp"
#include "perch/model/convex_hull.hpp"

namespace perch::app {
namespace {

constexpr double never = 1e6;    // metres: instead of a distance between different models
constexpr int axis_steps = 315;  // of a turn about an axis of symmetry, as BOP takes

/// The corners of a model's hull in its own frame: no other vertex is farther from itself after a motion.
std::vector<Eigen::Vector3f> corners_of(const BopModel& model) {
  std::vector<Eigen::Vector3f> corners = convex_hull(model.bodies[0].mesh).vertices;
  const Eigen::Isometry3f model_from_stood = model.bodies[0].stood_from_model.inverse().cast<float>();
  for (Eigen::Vector3f& p : corners) p = model_from_stood * p;
  return corners;
}

}  // namespace

void BopErrors::add(BopDataset& dataset, const BopImage& image, const Result& result,
                    const std::vector<BopTruthResidual>& residuals, bool shown) {
  if (image.truth.empty()) return;
  const auto rows = static_cast<Eigen::Index>(image.truth.size()),
             columns = static_cast<Eigen::Index>(result.objects.size());
  Eigen::MatrixXd distance = Eigen::MatrixXd::Constant(rows, columns, never);
  for (Eigen::Index t = 0; t < rows; ++t) {
    const BopTruth& truth = image.truth[static_cast<std::size_t>(t)];
    const BopModel& model = dataset.model(truth.obj_id);
    const std::vector<Eigen::Vector3f> corners = corners_of(model);
    const auto symmetries = model.symmetries.motions(axis_steps);
    for (Eigen::Index o = 0; o < columns; ++o) {
      const ObjectResult& object = result.objects[static_cast<std::size_t>(o)];
      if (!object.absent && image.scene.objects[static_cast<std::size_t>(o)].model == truth.model)
        distance(t, o) =
            largest_surface_distance(corners, object.camera_from_model, truth.camera_from_model, symmetries);
    }
  }
  const auto found = min_cost_assignment(distance);
  if (shown)
    fmt::print("{:<12} {:>10} {:>17} {:>17}\n", "annotated", "MSSD [mm]", "tilt [degrees]", "height [mm]");
  for (std::size_t t = 0; t < image.truth.size(); ++t) {
    const BopModel& model = dataset.model(image.truth[t].obj_id);
    const double mssd =
        found[t] ? distance(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(*found[t])) : never;
    distances_.push_back(mssd < never ? mssd : std::numeric_limits<double>::infinity());
    close_ += mssd < 0.1 * hull_diameter(convex_hull(model.bodies[0].mesh));
    if (!shown) continue;
    const BopTruthResidual& residual = residuals[t];
    fmt::print("{:<12} {:>10} {:>17.1f} {:>17}\n", model.bodies[0].name,
               mssd < never ? fmt::format("{:.1f}", 1000.0 * mssd) : std::string("not found"),
               residual.tilt * 180.0 / std::numbers::pi,
               residual.lift ? fmt::format("{:.1f}", 1000.0 * *residual.lift) : std::string("-"));
  }
}

void BopErrors::print() const {
  if (distances_.empty()) return;
  std::vector<double> sorted = distances_;
  std::sort(sorted.begin(), sorted.end());
  fmt::print("{} annotated objects: MSSD {:.1f} mm in the median; {} within a tenth of the diameter\n",
             sorted.size(), 1000.0 * sorted[sorted.size() / 2], close_);
}

}  // namespace perch::app
