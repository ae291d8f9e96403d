#pragma once

#include "perch/localize/result.hpp"

namespace perch {

/// A result in which every value differs from the others and from the defaults.
inline Result a_result() {
  Result r;
  r.status = Status::time_limit;
  r.reason = "why it ended";
  r.cost = CostRecord{812, 400, 412};
  r.observed_points = 30125;
  r.search_cost = 830;
  r.lower_bound = 64;
  r.guarantee = {.w = 1.5,
                 .over = "scenes",
                 .delta = 0.004,
                 .missing_depth = "ignore",
                 .clutter = Guarantee::Clutter{0.25, "ignore"},
                 .collision_penetration = 0.02,
                 .collision_overlap = 0.3,
                 .resolution_m = 0.04,
                 .yaw_resolution_rad = 0.3927,
                 .candidates = 3120,
                 .refine = "icp",
                 .search = "focal-mha"};
  r.search_objects = {{"can\xff", {0.1, 1.0 / 3.0, -0.7}}, {"mug", {}}};
  r.objects.resize(2);
  r.objects[0].model = "mug";
  r.objects[0].pose = {0.1 + 0.2, -1e-17, 3.141592653589793};
  r.objects[0].world_from_model = world_from_model(r.objects[0].pose, 0.25);
  r.objects[0].camera_from_model = r.objects[0].world_from_model.inverse();
  r.objects[0].visible_pixels = 2210;
  r.objects[0].visible_fraction = 1.0 / 7.0;
  r.objects[0].explained_fraction = 0.97;
  r.objects[0].confidence = 0.75;
  r.objects[0].runner_up = RunnerUp{{0.5, 0.25, -0.125}, -3};
  r.objects[1].model = "can\xff";
  r.stats = {15564, 100, 7, 4, 2, {1.5, 0.25, 0.5, 0.125, 0.2, 0.1, 0.3}, {1800, 31000, 21000000}};
  return r;
}

}  // namespace perch
