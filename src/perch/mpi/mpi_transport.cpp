#include "perch/mpi/mpi_transport.hpp"

#include <fmt/format.h>

#define OMPI_SKIP_MPICXX
#include <mpi.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <list>
#include <stdexcept>

#include "perch/core/error.hpp"

namespace perch {

/// What MPI may still have to read.
struct MpiTransport::Sent {
  struct Letter {
    MPI_Request request;
    std::shared_ptr<const Bytes> bytes;
  };
  std::list<Letter> letters;
};

MpiTransport::MpiTransport(int& argc, char**& argv) : sent_(std::make_unique<Sent>()) {
  // One thread talks, others compute.
  int given = MPI_THREAD_SINGLE;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &given);
  if (given < MPI_THREAD_FUNNELED) {
    MPI_Finalize();
    throw InputError("this MPI has no support for threads; build it with MPI_THREAD_FUNNELED");
  }
  int rank = 0, size = 1, near = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &near);
  MPI_Comm_free(&machine);
  rank_ = static_cast<std::size_t>(rank);
  size_ = static_cast<std::size_t>(size);
  on_this_machine_ = static_cast<std::size_t>(near);
}

MpiTransport::~MpiTransport() {
  flush();
  MPI_Finalize();
}

void MpiTransport::abort(int status) {
  MPI_Abort(MPI_COMM_WORLD, status);
  std::_Exit(status);
}

std::string MpiTransport::name() const {
  char machine[MPI_MAX_PROCESSOR_NAME + 1] = {};
  int length = 0;
  MPI_Get_processor_name(machine, &length);
  return fmt::format("rank {} on {}", rank_, std::string_view(machine, static_cast<std::size_t>(length)));
}

void MpiTransport::send(std::size_t to, Tag tag, std::shared_ptr<const Bytes> bytes) {
  if (bytes->size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw InputError(
        fmt::format("a message between processes has {} bytes, and MPI sends 2^31 - 1 at most; use a smaller "
                    "image or smaller meshes",
                    bytes->size()));
  collect();
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Isend(bytes->data(), static_cast<int>(bytes->size()), MPI_BYTE, static_cast<int>(to),
            static_cast<int>(tag), MPI_COMM_WORLD, &request);
  sent_->letters.push_back({request, std::move(bytes)});
}

std::optional<Message> MpiTransport::poll() {
  collect();
  int arrived = 0, size = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &arrived, &status);
  if (!arrived) return std::nullopt;
  MPI_Get_count(&status, MPI_BYTE, &size);
  auto bytes = std::make_shared<Bytes>(static_cast<std::size_t>(size));
  MPI_Recv(bytes->data(), size, MPI_BYTE, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
  return Message{static_cast<std::size_t>(status.MPI_SOURCE), static_cast<Tag>(status.MPI_TAG),
                 std::move(bytes)};
}

void MpiTransport::collect() {
  sent_->letters.remove_if([](Sent::Letter& letter) {
    int left = 0;
    MPI_Test(&letter.request, &left, MPI_STATUS_IGNORE);
    return left != 0;
  });
}

void MpiTransport::flush() {
  Backoff backoff(Backoff::Duration(1000));
  for (collect(); !sent_->letters.empty(); collect()) backoff.wait();
}

}  // namespace perch
