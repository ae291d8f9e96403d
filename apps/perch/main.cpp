#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <functional>
#include <new>
#include <string>

#include "command.hpp"
#include "perch/core/error.hpp"
#include "ranks.hpp"

namespace {

/// On one line, whatever the arguments hold that the message repeats.
void print_error(std::string message) {
  for (char& c : message)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  fmt::print(stderr, "perch: {}\n", message);
}

using namespace perch::app;

int run_command(int argc, char** argv, const Ranks& ranks) {
  CLI::App app("Finds known objects in a depth image, with a proven bound on how good the answer is.",
               "perch");
  app.set_version_flag("--version", PERCH_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 solved, or answered by a method without a bound; 1 no solution on this grid; 2 bad "
      "usage or input; 3 the time limit came "
      "first.");
  Run run;
  add_localize(app, run, ranks);
  add_score(app, run);
  add_evaluate(app, run);
  add_benchmark(app, run, ranks);
  add_inspect(app, run);
  add_simulate(app, run);
#ifdef PERCH_HAS_VERIFY
  add_verify(app, run);
#endif
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {  // --help, --version
    return app.exit(done);
  } catch (const CLI::ParseError& error) {
    print_error(fmt::format("{}; see perch --help", error.what()));
    return exit_bad_input;
  }
  return run();
}

/// Does it; what goes wrong is said on one line.
int reporting(const std::function<int()>& command) {
  try {
    return command();
  } catch (const perch::InputError& error) {
    print_error(error.what());
  } catch (const std::bad_alloc&) {
    print_error("out of memory; use a coarser grid, a smaller image or smaller meshes");
  } catch (const std::exception& error) {
    print_error(fmt::format("internal error: {}", error.what()));
  }
  return exit_bad_input;
}

}  // namespace

int main(int argc, char** argv) {
  return reporting([&] {
    Ranks ranks(argc, argv);
    if (!ranks.serves()) return reporting([&] { return run_command(argc, argv, ranks); });
    const int status = reporting([&] {
      ranks.serve();
      return int{exit_solved};
    });
    // The first would wait for this one.
    if (status != exit_solved) ranks.abort(status);
    return status;
  });
}
