#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "perch/eval/record.hpp"
#include "perch/io/result_file.hpp"
#include "perch/localize/scene.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {

/// The tightest of the paper's thresholds: what is within it needs no look at J.
inline constexpr Threshold tightest_threshold{0.01, 5.0 / 180.0 * std::numbers::pi};

/// The flat J of each of the given scenes, in order.
using CostOf = std::function<std::vector<std::int64_t>(const std::vector<std::vector<PlacedModel>>&)>;

/// Holds results against the truth of one scene.
class SceneEvaluator {
 public:
  /// \param scene with truth; must outlive this. \param name as records show it. \param table_height world
  /// height of the support plane, on which both truth and estimates are taken to stand. \param visible one
  /// fraction for each true object; where empty, the truth is rendered to find them.
  SceneEvaluator(const Scene& scene, std::string name, double table_height,
                 std::optional<std::vector<double>> visible = std::nullopt);

  /// Where there is no result: every object is missed.
  SceneRecord missing() const { return record_; }

  /// Repeats of a model are assigned to its true poses so that the sum over pairs of min(translation, 10 cm)
  /// + 1 cm * yaw / 180 degrees is least. Absent objects stand for none. \param cost_of with the settings
  /// that the result was made with; asked once, for the truth and for each assigned object that is not within
  /// `tightest_threshold`. Empty: no object is found to be ambiguous.
  SceneRecord evaluate(const ReportedResult& result, const CostOf& cost_of = {}) const;

 private:
  /// Of each true object the one in `result.objects` that stands for it.
  std::vector<std::optional<std::size_t>> assigned(const ReportedResult& result) const;
  PoseErrors errors(std::size_t object, const PlacedModel& estimate) const;
  void compare_costs(const std::vector<std::optional<PlacedModel>>& estimates, const CostOf& cost_of,
                     SceneRecord& record) const;
  /// Of the mesh as it stands.
  Eigen::Isometry3d camera_from_model(std::size_t model, const Pose& pose) const;

  const Scene& scene_;
  double table_height_;
  RaySlopes slopes_;
  std::vector<DepthPatch> true_patches_;  ///< each true object alone
  SceneRecord record_;                    ///< without a result
};

}  // namespace perch
