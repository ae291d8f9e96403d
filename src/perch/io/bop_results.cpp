#include "perch/io/bop_results.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace perch {

std::string bop_results_csv(const std::vector<BopEstimate>& estimates) {
  std::string csv = "scene_id,im_id,obj_id,score,R,t,time\n";
  for (const BopEstimate& e : estimates) {
    csv += fmt::format("{},{},{},{},", e.scene_id, e.im_id, e.obj_id, e.score);
    for (int i = 0; i < 9; ++i)
      csv += fmt::format("{}{}", i > 0 ? " " : "",
                         e.camera_from_model.linear()(i / 3, i % 3) + 0.0);  // never -0
    csv += ",";
    for (int i = 0; i < 3; ++i)
      csv += fmt::format("{}{}", i > 0 ? " " : "", 1000.0 * e.camera_from_model.translation()[i] + 0.0);
    csv += fmt::format(",{}\n", e.seconds);
  }
  return csv;
}

std::string bop_results_name(std::string method, const std::string& dataset, const std::string& split) {
  std::replace(method.begin(), method.end(), '_', '-');
  return fmt::format("{}_{}-{}.csv", method, dataset, split);
}

}  // namespace perch
