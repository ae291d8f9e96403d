#pragma once

#include <cstddef>
#include <limits>
#include <memory>

#include "perch/parallel/transport.hpp"

namespace perch {

/// How messages travel: a process's link carries what it sends and what it receives one after the other, each
/// way on its own; a message arrives `latency` after its last byte has left.
struct Link {
  double latency = 0.0;                                        ///< seconds
  double bandwidth = std::numeric_limits<double>::infinity();  ///< bytes a second
};

/// Processes that are threads of this one, for tests and to see what a network costs: a Transport for each.
class LocalNetwork {
 public:
  explicit LocalNetwork(std::size_t size, const Link& link = {});
  ~LocalNetwork();
  /// Lives as long as the network.
  Transport& of(std::size_t rank);

 private:
  struct State;
  class End;
  std::unique_ptr<State> state_;
};

}  // namespace perch
