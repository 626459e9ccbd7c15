// The batch of servo axes compiled for AVX2: four doubles or eight floats at once.
#include "stator/plant/batch/servo_batch_dispatch.hpp"
#include "stator/plant/batch/servo_batch_kernel.hpp"

namespace stator::plant::servo_batch {

bool step_avx2(const ServoBatchConstants<double>& constants, const ServoBatchPlants<double>& plants,
               ServoBatchBlock<double>* blocks, base::ServoLanes<double>* signals,
               std::size_t count) {
  return step_blocks<double, 32>(constants, plants, blocks, signals, count);
}

bool step_avx2(const ServoBatchConstants<float>& constants, const ServoBatchPlants<float>& plants,
               ServoBatchBlock<float>* blocks, base::ServoLanes<float>* signals,
               std::size_t count) {
  return step_blocks<float, 32>(constants, plants, blocks, signals, count);
}

void refresh_avx2(ServoBatchBlock<double>* blocks, std::size_t count) {
  refresh_blocks<double, 32>(blocks, count);
}

void refresh_avx2(ServoBatchBlock<float>* blocks, std::size_t count) {
  refresh_blocks<float, 32>(blocks, count);
}

}  // namespace stator::plant::servo_batch
