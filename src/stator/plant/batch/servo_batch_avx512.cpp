// The batch of servo axes compiled for AVX-512: eight doubles or sixteen floats at once.
#include "stator/plant/batch/servo_batch_dispatch.hpp"
#include "stator/plant/batch/servo_batch_kernel.hpp"

namespace stator::plant::servo_batch {

bool step_avx512(const ServoBatchConstants<double>& constants,
                 const ServoBatchPlants<double>& plants, ServoBatchBlock<double>* blocks,
                 base::ServoLanes<double>* signals, std::size_t count) {
  return step_blocks<double, 64>(constants, plants, blocks, signals, count);
}

bool step_avx512(const ServoBatchConstants<float>& constants, const ServoBatchPlants<float>& plants,
                 ServoBatchBlock<float>* blocks, base::ServoLanes<float>* signals,
                 std::size_t count) {
  return step_blocks<float, 64>(constants, plants, blocks, signals, count);
}

void refresh_avx512(ServoBatchBlock<double>* blocks, std::size_t count) {
  refresh_blocks<double, 64>(blocks, count);
}

void refresh_avx512(ServoBatchBlock<float>* blocks, std::size_t count) {
  refresh_blocks<float, 64>(blocks, count);
}

}  // namespace stator::plant::servo_batch
