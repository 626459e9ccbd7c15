#pragma once

#include "stator/base/lanes.hpp"
#include "stator/base/lanes_trigonometry.hpp"

// rotation.hpp over lanes, operation by operation. Included only by the kernels of ServoBatch.

namespace stator::plant::servo_batch {

template <typename L>
using Turn = base::SineCosineLanes<L>;

template <typename L>
[[nodiscard]] [[gnu::always_inline]] inline Turn<L> sum(const Turn<L>& a, const Turn<L>& b) {
  return {a.sine * b.cosine + a.cosine * b.sine, a.cosine * b.cosine - a.sine * b.sine};
}

template <typename L, typename N>
[[nodiscard]] [[gnu::always_inline]] inline Turn<L> small_turn(const typename L::Value& angle) {
  using V = typename L::Value;
  const V z = angle * angle;
  const V z2 = z * z;
  return {
      angle * ((N(1.0) - z * N(1.0 / 6.0)) + z2 * (N(1.0 / 120.0) - z * N(1.0 / 5040.0))),
      (N(1.0) - N(0.5) * z) + z2 * ((N(1.0 / 24.0) - z * N(1.0 / 720.0)) + z2 * N(1.0 / 40320.0))};
}

template <typename L, typename N>
[[nodiscard]] [[gnu::always_inline]] inline Turn<L> doubled(const Turn<L>& a) {
  return {N(2.0) * (a.sine * a.cosine), a.cosine * a.cosine - a.sine * a.sine};
}

template <typename L, typename N>
[[nodiscard]] [[gnu::always_inline]] inline Turn<L> tripled(const Turn<L>& a) {
  const typename L::Value square = N(4.0) * (a.sine * a.sine);
  return {a.sine * (N(3.0) - square), a.cosine * (N(1.0) - square)};
}

template <typename L, typename N>
[[nodiscard]] [[gnu::always_inline]] inline Turn<L> multiple(Turn<L> direction, int order) {
  for (; (order & 1) == 0; order >>= 1) {
    direction = doubled<L, N>(direction);
  }
  Turn<L> result = direction;
  for (order >>= 1; order > 0; order >>= 1) {
    direction = doubled<L, N>(direction);
    if ((order & 1) != 0) {
      result = sum<L>(result, direction);
    }
  }
  return result;
}

}  // namespace stator::plant::servo_batch
