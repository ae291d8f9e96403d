#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <new>

#include "command.hpp"
#include "perch/core/error.hpp"

int main(int argc, char** argv) {
  using namespace perch::app;
  CLI::App app("Finds known objects in a depth image, with a proven bound on how good the answer is.",
               "perch");
  app.set_version_flag("--version", PERCH_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 solved; 1 no solution on this grid; 2 bad usage or input; 3 the time limit came "
      "first.");
  Run run;
  add_localize(app, run);
  add_score(app, run);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {  // --help, --version
    return app.exit(done);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "perch: {}; see perch --help\n", error.what());
    return exit_bad_input;
  }
  try {
    return run();
  } catch (const perch::InputError& error) {
    fmt::print(stderr, "perch: {}\n", error.what());
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "perch: out of memory; use a coarser grid, a smaller image or smaller meshes\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "perch: internal error: {}\n", error.what());
  }
  return exit_bad_input;
}
