#pragma once

#include <memory>

#include "perch/parallel/transport.hpp"

namespace perch {

/// This process's part in an MPI job, from its making to the end of the program: one a program. Messages go
/// point to point, without collectives. Throws InputError where MPI gives no threads.
class MpiTransport final : public Transport {
 public:
  MpiTransport(int& argc, char**& argv);
  /// Ends the process's part. Every process must come here, or mpirun ends all.
  ~MpiTransport() override;

  std::size_t rank() const override { return rank_; }
  std::size_t size() const override { return size_; }
  std::string name() const override;
  using Transport::send;
  void send(std::size_t to, Tag tag, std::shared_ptr<const Bytes> bytes) override;
  std::optional<Message> poll() override;
  void flush() override;

  /// Ends all processes of the job at once.
  [[noreturn]] void abort(int status);

  /// How many of the job's processes run on this machine.
  std::size_t on_this_machine() const { return on_this_machine_; }

 private:
  struct Sent;
  /// Lets go of what has left.
  void collect();

  std::size_t rank_ = 0, size_ = 1, on_this_machine_ = 1;
  std::unique_ptr<Sent> sent_;
};

}  // namespace perch
