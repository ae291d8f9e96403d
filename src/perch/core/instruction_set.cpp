#include "perch/core/instruction_set.hpp"

#include <algorithm>

namespace perch {
namespace {

InstructionSet best() {
#ifdef PERCH_INSTRUCTION_SETS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("x86-64-v4")) return InstructionSet::x86_64_v4;
  if (__builtin_cpu_supports("x86-64-v3")) return InstructionSet::x86_64_v3;
#endif
  return InstructionSet::baseline;
}

InstructionSet& used() {
  static InstructionSet set = best();
  return set;
}

}  // namespace

InstructionSet instruction_set() {
  return used();
}

void use_instruction_set(InstructionSet set) {
  used() = std::min(set, best());
}

}  // namespace perch
