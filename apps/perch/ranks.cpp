#include "ranks.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "perch/core/error.hpp"
#ifdef PERCH_HAS_MPI
#include "benchmark_batch.hpp"
#include "perch/localize/services.hpp"
#include "perch/mpi/mpi_transport.hpp"
#include "perch/parallel/serve.hpp"
#include "perch/parallel/team_executor.hpp"
#endif

namespace perch::app {
namespace {

bool is_set(const char* variable) {
  return std::getenv(variable) != nullptr;
}

std::size_t number_in(const char* variable) {
  const char* text = std::getenv(variable);
  return text == nullptr ? 0 : std::strtoul(text, nullptr, 10);
}

/// How many processes were started, as far as the environment tells. mpirun's own word comes first: under
/// Slurm it starts its helpers by srun.
std::size_t started_together() {
  for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"})
    if (is_set(variable)) return std::max<std::size_t>(1, number_in(variable));
  return 1;
}

/// Open MPI finds the others by what its own mpirun sets, or a resource manager with PMIx or PMI.
[[maybe_unused]] bool can_meet() {
  return is_set("OMPI_COMM_WORLD_SIZE") || is_set("PMIX_RANK") || is_set("PMI_RANK");
}

}  // namespace

#ifdef PERCH_HAS_MPI

namespace {

/// Processors that this process may use, its part of them where several share a whole machine.
std::size_t own_processors(std::size_t on_this_machine) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  const long online = sysconf(_SC_NPROCESSORS_ONLN);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0 || online < 1) return 1;
  const auto own = static_cast<std::size_t>(CPU_COUNT(&allowed));
  const bool bound = own < static_cast<std::size_t>(online);
  return std::max<std::size_t>(1, bound ? own : own / on_this_machine);
}

/// What messages hold lies in memory as this program was compiled.
std::string program() {
  return fmt::format("perch {} with settings of {} bytes", PERCH_VERSION, sizeof(Settings));
}

}  // namespace

struct Ranks::Job {
  Job(int& argc, char**& argv) : transport(argc, argv) {}

  std::unique_ptr<Executor> own_executor(std::size_t threads) const {
    return make_executor(threads > 0 ? threads : own_processors(transport.on_this_machine()));
  }

  mutable MpiTransport transport;
};

Ranks::Ranks(int& argc, char**& argv) {
  if (can_meet()) job_ = std::make_unique<Job>(argc, argv);
  // An MPI that doesn't know the resource manager starts as if it were alone.
  if ((!job_ || job_->transport.size() == 1) && started_together() > 1)
    throw InputError(fmt::format(
        "was started {} times, but the processes can't find each other; start it by mpirun, or by srun "
        "--mpi=pmix",
        started_together()));
}

Ranks::~Ranks() {
  if (job_ && !serves()) dismiss(job_->transport);
}

bool Ranks::serves() const {
  return job_ && job_->transport.rank() > 0;
}

void Ranks::serve() {
  Services services = localization_services();
  services.emplace(BenchmarkBatch::service, make_benchmark_service());
  perch::serve(
      job_->transport, services, [&](std::size_t threads) { return job_->own_executor(threads); }, program());
}

std::unique_ptr<Executor> Ranks::executor(std::size_t threads) const {
  if (!job_) return make_executor(threads);
  auto own = job_->own_executor(threads);
  if (job_->transport.size() == 1) return own;
  return std::make_unique<TeamExecutor>(job_->transport, std::move(own), threads, program());
}

void Ranks::abort(int status) const {
  if (job_) job_->transport.abort(status);
  std::_Exit(status);
}

#else

struct Ranks::Job {};

Ranks::Ranks(int&, char**&) {
  if (started_together() > 1)
    throw InputError(
        fmt::format("was started {} times, but is built without MPI; install libopenmpi-dev and openmpi-bin "
                    "(script/bootstrap --mpi) and build it again, or start it once",
                    started_together()));
}

Ranks::~Ranks() = default;
bool Ranks::serves() const {
  return false;
}
void Ranks::serve() {}
std::unique_ptr<Executor> Ranks::executor(std::size_t threads) const {
  return make_executor(threads);
}
void Ranks::abort(int status) const {
  std::_Exit(status);
}

#endif

}  // namespace perch::app
