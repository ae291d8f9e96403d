#include "perch/sim/model_catalogue.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>

#include "perch/core/error.hpp"
#include "perch/sim/catalogue_shapes.hpp"
#include "perch/sim/chess_pieces.hpp"
#include "perch/sim/parametric_models.hpp"

namespace perch {
namespace {

struct CatalogueEntry {
  std::string name;
  Symmetry symmetry;
  std::function<Mesh()> mesh;
};

/// What the household set doesn't hold.
const std::vector<CatalogueEntry>& further_entries() {
  const Symmetry none = Symmetry::none(), round = Symmetry::continuous(), two = Symmetry::n_fold(2);
  static const std::vector<CatalogueEntry> entries{
      {"book", two,
       [] {
         return carton_mesh({.size = {0.21, 0.14, 0.03}});
       }},
      {"bottle_lying", none, [] { return on_its_side(bottle_mesh()); }},
      {"bowl_upside_down", round, [] { return upside_down(bowl_mesh()); }},
      {"can_lying", two, [] { return on_its_side(even_can_mesh(0.037, 0.11)); }},
      {"cereal_box", two,
       [] {
         return carton_mesh({.size = {0.19, 0.065, 0.28}});
       }},
      {"cereal_box_lying", two,
       [] {
         return on_its_side(carton_mesh({.size = {0.065, 0.19, 0.28}}));
       }},
      {"coffee_can", round, [] { return can_mesh({.radius = 0.051, .height = 0.14}); }},
      {"cookie_jar", round,
       [] { return jar_mesh({.radius = 0.062, .height = 0.15, .lid_radius = 0.05, .lid_height = 0.025}); }},
      {"crisps_can", round, [] { return can_mesh({.radius = 0.0375, .height = 0.235}); }},
      {"detergent", none, [] { return detergent_mesh(); }},
      {"dish", two, [] { return dish_mesh(0.11, 0.07, 0.05); }},
      {"espresso_cup", none,
       [] {
         return mug_mesh({.radius = 0.031,
                          .height = 0.058,
                          .wall = 0.004,
                          .bottom = 0.006,
                          .handle = {.top = 0.044,
                                     .bottom = 0.018,
                                     .reach = 0.02,
                                     .half_width = 0.005,
                                     .half_thickness = 0.0035}});
       }},
      {"glass_upside_down", round, [] { return upside_down(glass_mesh()); }},
      {"goblet", round, [] { return goblet_mesh(); }},
      {"hexagonal_box", Symmetry::n_fold(6),
       [] { return tin_mesh({.sides = 6, .radius = 0.075, .height = 0.05}); }},
      {"milk_carton", two, [] { return gabled_carton_mesh(0.072, 0.072, 0.225); }},
      {"milk_carton_lying", none, [] { return on_its_side(gabled_carton_mesh(0.072, 0.072, 0.225)); }},
      {"mill", round, [] { return mill_mesh(); }},
      {"mug_upside_down", none, [] { return upside_down(mug_mesh()); }},
      {"mustard", two,
       [] {
         return flat_bottle_mesh({.half_width = 0.046,
                                  .half_depth = 0.029,
                                  .height = 0.19,
                                  .cap_radius = 0.02,
                                  .cap_height = 0.045,
                                  .tip_radius = 0.006});
       }},
      {"pitcher", none,
       [] {
         return jug_mesh(
             {.bottom_radius = 0.045,
              .rim_radius = 0.052,
              .height = 0.15,
              .spout = 0.018,
              .handle = {
                  .top = 0.12, .bottom = 0.04, .reach = 0.04, .half_width = 0.009, .half_thickness = 0.005}});
       }},
      {"plate", round, [] { return plate_mesh(0.115, 0.07, 0.024); }},
      {"pudding_box", two,
       [] {
         return carton_mesh({.size = {0.11, 0.09, 0.035}});
       }},
      {"salad_bowl", round,
       [] { return bowl_mesh({.radius = 0.11, .height = 0.085, .foot_radius = 0.045, .wall = 0.004}); }},
      {"sauce_bottle", round,
       [] {
         return bottle_mesh({.radius = 0.027, .height = 0.165, .neck_radius = 0.011, .shoulder = 0.095});
       }},
      {"saucepan", none, [] { return saucepan_mesh(); }},
      {"saucer", round, [] { return plate_mesh(0.075, 0.045, 0.018); }},
      {"shampoo", two, [] { return flat_bottle_mesh({}); }},
      {"shampoo_lying", none,
       [] { return on_its_side(flat_bottle_mesh({.half_width = 0.022, .half_depth = 0.042})); }},
      {"soup_cup", two, [] { return soup_cup_mesh(); }},
      {"spice_jar", round,
       [] { return jar_mesh({.radius = 0.024, .height = 0.105, .lid_radius = 0.023, .lid_height = 0.02}); }},
      {"sprayer", none,
       [] { return spray_bottle_mesh({.half_width = 0.034, .half_depth = 0.026, .height = 0.2}); }},
      {"stein", none,
       [] {
         return mug_mesh({.radius = 0.048,
                          .height = 0.155,
                          .wall = 0.006,
                          .bottom = 0.012,
                          .handle = {.top = 0.13,
                                     .bottom = 0.03,
                                     .reach = 0.042,
                                     .half_width = 0.009,
                                     .half_thickness = 0.006}});
       }},
      {"sugar_box", two,
       [] {
         return carton_mesh({.size = {0.092, 0.04, 0.175}});
       }},
      {"teapot", none, [] { return teapot_mesh(); }},
      {"tuna_can", round, [] { return even_can_mesh(0.0425, 0.034); }},
      {"tumbler", round,
       [] {
         return glass_mesh(
             {.bottom_radius = 0.035, .rim_radius = 0.04, .height = 0.09, .wall = 0.003, .bottom = 0.01});
       }},
      {"vase", round, [] { return vase_mesh(); }},
      {"watering_can", none, [] { return watering_can_mesh(); }},
      {"wine_bottle", round,
       [] {
         return bottle_mesh({.radius = 0.0375, .height = 0.3, .neck_radius = 0.0145, .shoulder = 0.19});
       }},
  };
  return entries;
}

[[noreturn]] void fail_unknown(std::string_view name, const std::vector<std::string>& known) {
  throw InputError(fmt::format("no model is called '{}'; there are: {}", name, fmt::join(known, ", ")));
}

}  // namespace

const std::vector<std::string>& catalogue_model_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = household_model_names();
    for (const CatalogueEntry& entry : further_entries()) all.push_back(entry.name);
    std::sort(all.begin(), all.end());
    return all;
  }();
  return names;
}

SceneModel catalogue_model(std::string_view name) {
  for (const CatalogueEntry& entry : further_entries())
    if (entry.name == name) return {entry.name, entry.mesh(), entry.symmetry, 0.0};
  const auto& household = household_model_names();
  if (std::find(household.begin(), household.end(), name) == household.end())
    fail_unknown(name, catalogue_model_names());
  return household_model(name);
}

SceneModel named_model(std::string_view name) {
  const auto in = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (in(chess_model_names())) return chess_model(name);
  if (in(catalogue_model_names())) return catalogue_model(name);
  std::vector<std::string> all = catalogue_model_names();
  all.insert(all.end(), chess_model_names().begin(), chess_model_names().end());
  fail_unknown(name, all);
}

}  // namespace perch
