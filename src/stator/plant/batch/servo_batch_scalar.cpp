// The batch of servo axes without vectors, a lane at a time: the reference for all other
// instruction sets.
#include "stator/plant/batch/servo_batch_dispatch.hpp"
#include "stator/plant/batch/servo_batch_kernel.hpp"

namespace stator::plant::servo_batch {

bool step_scalar(const ServoBatchConstants<double>& constants,
                 const ServoBatchPlants<double>& plants, ServoBatchBlock<double>* blocks,
                 base::ServoLanes<double>* signals, std::size_t count) {
  return step_blocks<double, 8>(constants, plants, blocks, signals, count);
}

bool step_scalar(const ServoBatchConstants<float>& constants, const ServoBatchPlants<float>& plants,
                 ServoBatchBlock<float>* blocks, base::ServoLanes<float>* signals,
                 std::size_t count) {
  return step_blocks<float, 4>(constants, plants, blocks, signals, count);
}

void refresh_scalar(ServoBatchBlock<double>* blocks, std::size_t count) {
  refresh_blocks<double, 8>(blocks, count);
}

void refresh_scalar(ServoBatchBlock<float>* blocks, std::size_t count) {
  refresh_blocks<float, 4>(blocks, count);
}

}  // namespace stator::plant::servo_batch
