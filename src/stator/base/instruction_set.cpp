#include "stator/base/instruction_set.hpp"

namespace stator::base {

bool supported(InstructionSet set) {
  switch (set) {
#if defined(__x86_64__)
    case InstructionSet::avx2:
      return __builtin_cpu_supports("avx2") != 0;
    case InstructionSet::avx512:
      return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
             __builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("avx512bw") != 0;
#else
    case InstructionSet::avx2:
    case InstructionSet::avx512:
      return false;
#endif
    default:
      return true;
  }
}

InstructionSet best_instruction_set() {
  if (supported(InstructionSet::avx512)) {
    return InstructionSet::avx512;
  }
  return supported(InstructionSet::avx2) ? InstructionSet::avx2 : InstructionSet::baseline;
}

}  // namespace stator::base
