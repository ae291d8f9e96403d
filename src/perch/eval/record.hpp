#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "perch/eval/surface_discrepancy.hpp"
#include "perch/localize/result.hpp"

// What an evaluation knows of each object, scene and method. Everything else is made of these.
namespace perch {

/// How far an estimated pose is off, by every metric (docs/evaluation.md).
struct PoseErrors {
  double translation = 0.0;  ///< in x and y, metres
  double yaw = 0.0;          ///< modulo the truth's symmetry, radians; 0 where that is continuous
  double add = 0.0;          ///< metres
  double add_s = 0.0;        ///< metres
  double mssd = 0.0;         ///< metres
  double mspd = 0.0;         ///< pixels of an image 640 wide; infinite where the object isn't in front of the
                             ///< camera
  std::array<double, tolerance_count> vsd{};  ///< at each tolerance, in [0, 1]
  bool other_rest_pose = false;               ///< than the truth's: no threshold holds, and yaw is pi
};

/// The flat J of the true scene, and of that scene with one object at its estimated pose instead.
struct CostComparison {
  std::int64_t of_truth = 0;
  std::int64_t of_estimate = 0;
};

/// Within both limits counts as recognized: the paper's criterion.
struct Threshold {
  double translation = 0.0;  ///< metres
  double yaw = 0.0;          ///< radians; pi and more: any yaw

  bool holds(const PoseErrors& errors) const {
    return !errors.other_rest_pose && errors.translation < translation &&
           (errors.yaw < yaw || yaw >= std::numbers::pi);
  }
};

enum class Verdict {
  within,     ///< the threshold
  ambiguous,  ///< not within, but the depth image doesn't tell its pose from the true one: J is no higher
  missed      ///< not found, or wrong
};

constexpr const char* name(Verdict verdict) {
  return verdict == Verdict::within ? "within" : verdict == Verdict::ambiguous ? "ambiguous" : "missed";
}

/// One true object.
struct ObjectRecord {
  std::string model;
  double visible_fraction = 0.0;        ///< in [0, 1]
  double diameter = 0.0;                ///< of the model, metres
  bool symmetric = false;               ///< about z, continuous or n-fold
  std::optional<PoseErrors> errors;     ///< empty where no object of the result stands for it
  std::optional<double> confidence;     ///< as the result states it
  std::optional<CostComparison> costs;  ///< where it was looked whether the pose can be told

  Verdict verdict(const Threshold& threshold) const {
    if (errors && threshold.holds(*errors)) return Verdict::within;
    return costs && costs->of_estimate <= costs->of_truth ? Verdict::ambiguous : Verdict::missed;
  }
};

/// What a result states of the run that made it.
struct RunRecord {
  Status status = Status::infeasible;
  double seconds = 0.0;
  std::int64_t rendered = 0;                  ///< hypotheses
  std::int64_t expanded = 0;                  ///< states or nodes of the search
  std::optional<double> suboptimality_bound;  ///< proven; empty where there is none
};

/// One scene as one method solved it.
struct SceneRecord {
  std::string scene;
  std::optional<RunRecord> run;       ///< empty where there is no result: all objects are missed
  std::size_t surplus = 0;            ///< objects that the result placed and the truth lacks
  std::vector<ObjectRecord> objects;  ///< in the order of the truth
};

struct MethodRecord {
  std::string method;
  std::vector<SceneRecord> scenes;
};

}  // namespace perch
