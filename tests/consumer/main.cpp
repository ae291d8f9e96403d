#include <cstdio>
#include <exception>

#include "perch/io/scene_file.hpp"
#include "perch/localize/localize.hpp"
#include "perch/localize/prepare.hpp"

/// Localizes the scene that its one argument names, on a coarse grid, and prints the cost.
int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: consumer SCENE\n");
    return 2;
  }
  try {
    perch::Settings settings;
    perch::set_field(settings, "grid.resolution", "0.08");
    perch::set_field(settings, "grid.yaw_resolution_deg", "45");
    const auto executor = perch::make_executor(2);
    const perch::Scene scene = perch::prepare(perch::read_scene(argv[1]), settings, *executor);
    const auto stop = perch::StopCondition::after(30.0);
    const perch::Result result = perch::localize(scene, settings, *executor, stop);
    if (!result.cost || result.objects.size() != scene.objects.size()) {
      std::fprintf(stderr, "no scene: %s\n", result.reason.c_str());
      return 1;
    }
    std::printf("cost %lld of %lld observed points\n", static_cast<long long>(result.cost->cost),
                static_cast<long long>(result.observed_points));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
