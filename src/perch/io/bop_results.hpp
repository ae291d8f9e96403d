#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace perch {

/// A row of BOP's results file.
struct BopEstimate {
  int scene_id = 0, im_id = 0, obj_id = 0;
  double score = 0.0;                                                   ///< higher: surer
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();  ///< metres; the model as in its file
  double seconds = -1.0;  ///< of the whole image, the same in all its rows; -1: not known
};

/// The CSV file of the BOP challenge: a header, then scene_id,im_id,obj_id,score,R,t,time, where R is 9
/// numbers row after row and t 3 in millimetres, with blanks between.
std::string bop_results_csv(const std::vector<BopEstimate>& estimates);

/// What BOP calls such a file: METHOD_DATASET-SPLIT.csv; underscores in the method become hyphens.
std::string bop_results_name(std::string method, const std::string& dataset, const std::string& split);

}  // namespace perch
