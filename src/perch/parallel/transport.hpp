#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "perch/core/bytes.hpp"

namespace perch {

/// What a message between processes is.
enum class Tag : std::uint8_t {
  hello,    ///< from the first process: how many threads to use; to it: how many are used, by which program
  news,     ///< what Executor::tell says; passed on from process to process
  portion,  ///< items of a batch to work on
  stop,     ///< give up what is left of a batch
  quit,     ///< no more is to come
  answers,  ///< to a portion
  failure   ///< what a process could not do, and why
};

struct Message {
  std::size_t from = 0;
  Tag tag = Tag::quit;
  std::shared_ptr<const Bytes> bytes;

  ByteReader read() const { return ByteReader(*bytes); }
};

/// Carries messages between numbered processes, 0 .. size() - 1. Those from one to another arrive in order.
/// Used by one thread.
class Transport {
 public:
  virtual ~Transport() = default;
  virtual std::size_t rank() const = 0;
  virtual std::size_t size() const = 0;
  /// For messages to people: which process this is and where it runs.
  virtual std::string name() const = 0;
  /// Doesn't wait until it has arrived. Several may be sent the same bytes.
  virtual void send(std::size_t to, Tag tag, std::shared_ptr<const Bytes> bytes) = 0;
  void send(std::size_t to, Tag tag, Bytes bytes) {
    send(to, tag, std::make_shared<const Bytes>(std::move(bytes)));
  }
  /// What has arrived next, from whoever; empty where nothing has.
  virtual std::optional<Message> poll() = 0;
  /// Waits until all that was sent has left.
  virtual void flush() = 0;
};

/// Sleeps between looks at what may have arrived: hardly at first, then longer and longer, so that waiting
/// keeps no core busy.
class Backoff {
 public:
  using Duration = std::chrono::microseconds;
  explicit Backoff(Duration longest) : longest_(longest) {}

  void wait() {
    std::this_thread::sleep_for(next_);
    next_ = std::min(2 * next_, longest_);
  }
  void reset() { next_ = first; }

 private:
  static constexpr Duration first{10};
  Duration next_ = first, longest_;
};

}  // namespace perch
