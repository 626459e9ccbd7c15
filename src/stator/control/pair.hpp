#pragma once

namespace stator::control {

/// Two numbers a processor computes with at once, each as if it were alone: the same bits as from
/// two scalar operations, for one instruction.
using Pair = double __attribute__((vector_size(16)));

[[nodiscard]] inline Pair both(double x) {
  return Pair{x, x};
}

}  // namespace stator::control
