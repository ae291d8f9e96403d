#pragma once

#include <cstdint>
#include <vector>

namespace perch {

/// Numbers first .. last - 1 of a set that is kept as runs.
struct Run {
  std::uint32_t first = 0, last = 0;
};

/// Adds numbers first .. last - 1, larger than all before them.
inline void append(std::vector<Run>& runs, std::uint32_t first, std::uint32_t last) {
  if (!runs.empty() && runs.back().last == first)
    runs.back().last = last;
  else
    runs.push_back({first, last});
}

/// Adds a number larger than all before it.
inline void append(std::vector<Run>& runs, std::uint32_t number) {
  append(runs, number, number + 1);
}

/// Adds the numbers of the set bits, counted from `first`; all larger than those before.
inline void append_runs(std::vector<Run>& runs, unsigned bits, std::uint32_t first) {
  while (bits != 0) {
    const auto from = static_cast<std::uint32_t>(__builtin_ctz(bits));
    const auto length = static_cast<std::uint32_t>(__builtin_ctz(~(bits >> from)));
    append(runs, first + from, first + from + length);
    bits &= ~(((1U << length) - 1U) << from);
  }
}

}  // namespace perch
