#pragma once

#include <cstdint>
#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define PERCH_INSTRUCTION_SETS 1
#endif

#define PERCH_INLINE inline __attribute__((always_inline))

namespace perch {

/// How many numbers the inner loops work on together, see lanes.inc.
inline constexpr int lane_count = 8;

/// What the inner loops are compiled for, once each; results are the same on all.
enum class InstructionSet { baseline, x86_64_v3, x86_64_v4 };

/// The best that this processor has, or what was asked for.
InstructionSet instruction_set();
/// For tests: what to use from now on, at most the best that this processor has. Not while others run.
void use_instruction_set(InstructionSet set);

}  // namespace perch
