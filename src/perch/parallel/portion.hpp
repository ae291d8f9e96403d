#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "perch/core/bytes.hpp"

namespace perch {

// The messages of Tag::portion, Tag::answers and Tag::failure: a head, then what it says follows.

/// Head of some items of a batch; what all have in common follows where this is a process's first portion of
/// the batch, then the questions.
struct PortionHead {
  std::uint64_t batch = 0;   ///< counted from 1
  std::uint64_t number = 0;  ///< of the portion, counted over all batches
  std::uint64_t news = 0;    ///< how many messages of Tag::news come before it
  std::string topic;
  std::uint64_t grain = 1;
  bool fills_process = false;
  bool has_common = false;
  std::uint64_t items = 0;

  void write(ByteWriter& to) const;
  static PortionHead read(ByteReader& from);
};

/// Head of the answers to a portion; a report follows, then the answers.
struct AnswersHead {
  std::uint64_t number = 0;  ///< of the portion
  bool complete = false;     ///< else it was stopped, and nothing follows
  double seconds = 0.0;      ///< from the start of the portion to its end

  void write(ByteWriter& to) const;
  static AnswersHead read(ByteReader& from);
};

/// What went wrong in a process.
struct Failure {
  enum class Kind : std::uint8_t { input, memory, internal };
  std::uint64_t number = 0;  ///< of the portion that it answers; 0: of none
  Kind kind = Kind::internal;
  std::string what;

  /// Of the exception that is being handled.
  static Failure current(std::uint64_t number, const std::string& process);
  [[noreturn]] void raise() const;

  void write(ByteWriter& to) const;
  static Failure read(ByteReader& from);
};

}  // namespace perch
