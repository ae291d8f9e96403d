#include <fmt/format.h>

#include <cstdio>

#include "perch/core/error.hpp"
#include "perch/sim/example_scene.hpp"
#include "perch/sim/scene_folder.hpp"

/// Writes the example scene into the folder that is its one argument.
int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: perch_make_example FOLDER\n");
    return 2;
  }
  try {
    perch::write_scene_folder(argv[1], perch::tabletop_example(), perch::tabletop_example_comment());
  } catch (const perch::InputError& error) {
    fmt::print(stderr, "perch_make_example: {}\n", error.what());
    return 2;
  }
  return 0;
}
