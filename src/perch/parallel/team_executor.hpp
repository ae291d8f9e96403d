#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "perch/parallel/executor.hpp"
#include "perch/parallel/transport.hpp"

namespace perch {

/// The first of several processes, which runs the program; the others serve() it. for_each runs on its own
/// threads, spread on those of all.
class TeamExecutor final : public Executor {
 public:
  /// Waits until all are ready. Keeps a reference. \param own this process's threads. \param threads of each
  /// other process; 0 = as many as it should have. \param program as serve() is told. Throws InputError where
  /// another process is of another one.
  TeamExecutor(Transport& transport, std::unique_ptr<Executor> own, std::size_t threads,
               const std::string& program);
  ~TeamExecutor() override;

  std::size_t workers() const override;
  bool for_each(std::size_t n, const Body& body, const StopCondition& stop) const override;
  /// Throws what went wrong in another process, as an InputError that names it or a std::runtime_error.
  bool spread(Batch& batch, const StopCondition& stop) const override;
  const Executor& own() const override;
  std::size_t processes() const override;
  void tell(const std::string& topic, Bytes what) const override;
  Traffic traffic() const override;

 private:
  struct Team;
  std::unique_ptr<Team> team_;
};

}  // namespace perch
