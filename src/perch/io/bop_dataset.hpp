#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "perch/io/bop_models.hpp"
#include "perch/io/bop_targets.hpp"
#include "perch/localize/scene.hpp"

namespace perch {

/// How a data set is read.
struct BopOptions {
  std::string split = "test";
  std::string models;  ///< folder of the models; empty: the first of models, models_eval, models_cad there is
  bool upright = false;      ///< models stand as in their files, in no other pose
  bool masks = false;        ///< what is an object is given by mask_visib
  bool camera_pose = false;  ///< the camera stands where cam_R_w2c and cam_t_w2c say; else as the plane says
};

/// An annotated pose; `model` is the first body of its model in the scene.
struct BopTruth {
  int obj_id = 0;
  std::size_t model = 0;
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();  ///< metres; the model as in its file
};

/// An image to be localized.
struct BopImage {
  int scene_id = 0, im_id = 0;
  Scene scene;                  ///< its models are called obj_000001 and so on; without truth
  std::vector<int> obj_ids;     ///< of each body of the scene
  std::vector<BopTruth> truth;  ///< of the models looked for; empty without scene_gt.json
};

/// A data set in BOP layout ("BOP: Benchmark for 6D Object Pose Estimation", Hodan et al. 2018), scene by
/// scene: DATASET/SPLIT/SCENE/depth/IMAGE.png and what describes it. Everything that is read is in metres.
class BopDataset {
 public:
  /// Throws InputError where the folder, the split or the models are missing.
  BopDataset(const std::filesystem::path& folder, const BopOptions& options);
  ~BopDataset();

  const std::string& name() const { return name_; }  ///< that of its folder
  /// The objects that scene_gt.json annotates in an image. Throws InputError, also where there are none.
  BopImageTargets annotated_objects(int scene_id, int im_id);
  /// Throws InputError. The scene's camera pose, table and background are open where the options say so.
  BopImage image(const BopImageTargets& targets);
  /// As BopModels::get.
  const BopModel& model(int obj_id) { return models_.get(obj_id); }

 private:
  struct SceneFiles;
  const SceneFiles& scene_files(int scene_id);
  void read_masks(const BopImageTargets& targets, const SceneFiles& files, Scene& scene) const;

  std::filesystem::path folder_;
  std::string name_;
  BopOptions options_;
  BopModels models_;
  std::unique_ptr<const SceneFiles> open_;  ///< of the scene asked for last: targets come scene by scene
};

/// How far an annotated pose is from what can be found: from a body that stands on the plane.
struct BopTruthResidual {
  double tilt = 0.0;           ///< angle between what points up and what should, radians
  std::optional<double> lift;  ///< height of the body, stood upright, above where it should stand, metres;
                               ///< empty where the height of the plane is not known
};

/// Sets the truth of a prepared scene, whose camera pose is known: each annotated pose becomes that of the
/// body of its model that is to be tilted least to get there, modulo the model's symmetries. Returns how far
/// each is from that, in the same order.
std::vector<BopTruthResidual> set_bop_truth(BopDataset& dataset, const std::vector<BopTruth>& truth,
                                            Scene& scene);

}  // namespace perch
