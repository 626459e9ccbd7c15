#pragma once

#include <cstddef>

#include "stator/base/servo_lanes.hpp"

namespace stator::control {

/// State of the current loops of one block of base::ServoLanes, and what they are told.
template <typename Number>
struct alignas(64) CurrentLoopBlock {
  static constexpr std::size_t kLanes = base::ServoLanes<Number>::kLanes;

  Number direct_target[kLanes];        ///< A
  Number quadrature_target[kLanes];    ///< A
  Number direct_integral[kLanes];      ///< V
  Number quadrature_integral[kLanes];  ///< V
  Number direct_current[kLanes];       ///< A, measured in the latest period
  Number quadrature_current[kLanes];   ///< A, measured in the latest period
};

template <typename Number>
struct CurrentLoopConstants {
  Number proportional{};  ///< V/A
  Number integral{};      ///< V/A per period
  Number timer_steps{};   ///< of a PWM period; 0: any duty can be made
  Number inverse_timer_steps{};
};

/// One period of the lanes of `count` blocks.
template <typename Number>
using CurrentLoopStep = void (*)(const CurrentLoopConstants<Number>& constants,
                                 CurrentLoopBlock<Number>* blocks,
                                 base::ServoLanes<Number>* signals, std::size_t count);

namespace current_loop {

// The kernels, each in a file of its own that is compiled for its instruction set.

#define STATOR_DECLARE_KERNELS(set)                                                                \
  void step_##set(const CurrentLoopConstants<double>& constants, CurrentLoopBlock<double>* blocks, \
                  base::ServoLanes<double>* signals, std::size_t count);                           \
  void step_##set(const CurrentLoopConstants<float>& constants, CurrentLoopBlock<float>* blocks,   \
                  base::ServoLanes<float>* signals, std::size_t count)

STATOR_DECLARE_KERNELS(scalar);
STATOR_DECLARE_KERNELS(baseline);
STATOR_DECLARE_KERNELS(avx2);
STATOR_DECLARE_KERNELS(avx512);

#undef STATOR_DECLARE_KERNELS

}  // namespace current_loop

}  // namespace stator::control
