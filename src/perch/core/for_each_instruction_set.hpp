// Compiles the file PERCH_KERNELS once for each instruction set, in namespaces of their own. No include
// guard: a source file defines PERCH_KERNELS, includes this once, and calls a kernel by PERCH_CALL. What the
// kernels need of the standard library is included before. Results are the same on all: no fused multiply-add
// (-ffp-contract=off), and the same operations in the same order.
//
// PERCH_X86_64_LEVEL says which one it is, since the compiler's own macros (__AVX__) don't change with the
// target inside a file.
//
// Not target_clones: it takes vectors apart for the oldest processor before it makes the clones.

#include "perch/core/instruction_set.hpp"

#ifdef PERCH_INSTRUCTION_SETS
#include <immintrin.h>
#endif

namespace perch {
namespace {

#define PERCH_X86_64_LEVEL 1
namespace baseline {
#include "perch/core/lanes.inc"
#include PERCH_KERNELS
}  // namespace baseline
#undef PERCH_X86_64_LEVEL

#ifdef PERCH_INSTRUCTION_SETS
#pragma GCC push_options
#pragma GCC target("arch=x86-64-v3")
#define PERCH_X86_64_LEVEL 3
namespace x86_64_v3 {
#include "perch/core/lanes.inc"
#include PERCH_KERNELS
}  // namespace x86_64_v3
#undef PERCH_X86_64_LEVEL
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("arch=x86-64-v4")
#define PERCH_X86_64_LEVEL 4
namespace x86_64_v4 {
#include "perch/core/lanes.inc"
#include PERCH_KERNELS
}  // namespace x86_64_v4
#undef PERCH_X86_64_LEVEL
#pragma GCC pop_options
#endif

}  // namespace
}  // namespace perch

/// Calls the kernel compiled for the instruction set in use.
#ifdef PERCH_INSTRUCTION_SETS
#define PERCH_CALL(kernel, ...)                                       \
  (::perch::instruction_set() == ::perch::InstructionSet::x86_64_v4   \
       ? ::perch::x86_64_v4::kernel(__VA_ARGS__)                      \
   : ::perch::instruction_set() == ::perch::InstructionSet::x86_64_v3 \
       ? ::perch::x86_64_v3::kernel(__VA_ARGS__)                      \
       : ::perch::baseline::kernel(__VA_ARGS__))
#else
#define PERCH_CALL(kernel, ...) ::perch::baseline::kernel(__VA_ARGS__)
#endif
