// The batch of servo axes for the vectors that every processor of the target has: two doubles or
// four floats at once.
#include "stator/plant/batch/servo_batch_dispatch.hpp"
#include "stator/plant/batch/servo_batch_kernel.hpp"

namespace stator::plant::servo_batch {

bool step_baseline(const ServoBatchConstants<double>& constants,
                   const ServoBatchPlants<double>& plants, ServoBatchBlock<double>* blocks,
                   base::ServoLanes<double>* signals, std::size_t count) {
  return step_blocks<double, 16>(constants, plants, blocks, signals, count);
}

bool step_baseline(const ServoBatchConstants<float>& constants,
                   const ServoBatchPlants<float>& plants, ServoBatchBlock<float>* blocks,
                   base::ServoLanes<float>* signals, std::size_t count) {
  return step_blocks<float, 16>(constants, plants, blocks, signals, count);
}

void refresh_baseline(ServoBatchBlock<double>* blocks, std::size_t count) {
  refresh_blocks<double, 16>(blocks, count);
}

void refresh_baseline(ServoBatchBlock<float>* blocks, std::size_t count) {
  refresh_blocks<float, 16>(blocks, count);
}

}  // namespace stator::plant::servo_batch
