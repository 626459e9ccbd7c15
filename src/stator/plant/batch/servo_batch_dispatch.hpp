#pragma once

#include "stator/plant/batch/servo_batch_block.hpp"

namespace stator::plant::servo_batch {

// The kernels, each in a file of its own that is compiled for its instruction set.

#define STATOR_DECLARE_KERNELS(set)                                                        \
  bool step_##set(const ServoBatchConstants<double>& constants,                            \
                  const ServoBatchPlants<double>& plants, ServoBatchBlock<double>* blocks, \
                  base::ServoLanes<double>* signals, std::size_t count);                   \
  bool step_##set(const ServoBatchConstants<float>& constants,                             \
                  const ServoBatchPlants<float>& plants, ServoBatchBlock<float>* blocks,   \
                  base::ServoLanes<float>* signals, std::size_t count);                    \
  void refresh_##set(ServoBatchBlock<double>* blocks, std::size_t count);                  \
  void refresh_##set(ServoBatchBlock<float>* blocks, std::size_t count)

STATOR_DECLARE_KERNELS(scalar);
STATOR_DECLARE_KERNELS(baseline);
STATOR_DECLARE_KERNELS(avx2);
STATOR_DECLARE_KERNELS(avx512);

#undef STATOR_DECLARE_KERNELS

}  // namespace stator::plant::servo_batch
