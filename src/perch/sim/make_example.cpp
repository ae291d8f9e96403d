#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <stdexcept>
#include <string_view>

#include "perch/core/error.hpp"
#include "perch/sim/example_scene.hpp"
#include "perch/sim/scene_folder.hpp"
#include "perch/sim/scene_generator.hpp"

namespace {

template <typename T>
T whole(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw perch::InvalidSetting(fmt::format("{}: is no whole number in range", text));
  return value;
}

perch::SimulatedScene tabletop(std::uint64_t seed, int objects) {
  perch::TabletopOptions options;
  options.min_objects = options.max_objects = objects;
  return perch::random_tabletop(seed, options);
}

}  // namespace

/// Writes the example scene into a folder, or a random tabletop of so many objects.
int main(int argc, char** argv) {
  if (argc != 2 && argc != 4) {
    fmt::print(stderr, "usage: perch_make_example FOLDER [SEED OBJECTS]\n");
    return 2;
  }
  try {
    if (argc == 2)
      perch::write_scene_folder(argv[1], perch::tabletop_example(), perch::tabletop_example_comment());
    else
      perch::write_scene_folder(argv[1], tabletop(whole<std::uint64_t>(argv[2]), whole<int>(argv[3])),
                                fmt::format("Random tabletop of {} objects, seed {}.", argv[3], argv[2]));
  } catch (const std::runtime_error& error) {
    fmt::print(stderr, "perch_make_example: {}\n", error.what());
    return 2;
  }
  return 0;
}
