#pragma once

#include <cstdint>

namespace stator::base {

/// Which vectors a calculation over many lanes uses. Results do not depend on it, only their speed.
enum class InstructionSet : std::uint8_t {
  scalar,    ///< one lane at a time
  baseline,  ///< vectors of 16 bytes, which every processor of the architecture has
  avx2,      ///< 32 bytes
  avx512,    ///< 64 bytes: AVX-512 F, DQ, VL, BW
};

/// Whether this program has code for it and this processor can run that.
[[nodiscard]] bool supported(InstructionSet set);

/// The widest one that is supported.
[[nodiscard]] InstructionSet best_instruction_set();

}  // namespace stator::base
