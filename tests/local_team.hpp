#pragma once

#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "perch/parallel/local_network.hpp"
#include "perch/parallel/serve.hpp"
#include "perch/parallel/team_executor.hpp"

namespace perch {

/// Several processes that are threads of this one: executor() is the first's, the others serve it.
class LocalTeam {
 public:
  /// \param services called once for each process but the first, e.g. localization_services. \param threads
  /// of each process.
  LocalTeam(std::size_t processes, std::size_t threads, const std::function<Services()>& services,
            const Link& link = {})
      : network_(processes, link) {
    for (std::size_t rank = 1; rank < processes; ++rank)
      others_.emplace_back(
          [this, rank, own = services()] { serve(network_.of(rank), own, make_executor, program); });
    executor_ = std::make_unique<TeamExecutor>(network_.of(0), make_executor(threads), threads, program);
  }
  ~LocalTeam() {
    dismiss(network_.of(0));
    for (std::thread& other : others_) other.join();
  }
  LocalTeam(const LocalTeam&) = delete;
  LocalTeam& operator=(const LocalTeam&) = delete;

  const TeamExecutor& executor() const { return *executor_; }

 private:
  static constexpr const char* program = "test";

  LocalNetwork network_;
  std::vector<std::thread> others_;
  std::unique_ptr<TeamExecutor> executor_;
};

}  // namespace perch
