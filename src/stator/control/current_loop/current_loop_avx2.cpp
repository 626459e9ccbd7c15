// The current loops compiled for AVX2: four doubles or eight floats at once.
#include "stator/control/current_loop/current_loop_kernel.hpp"

namespace stator::control::current_loop {

void step_avx2(const CurrentLoopConstants<double>& constants, CurrentLoopBlock<double>* blocks,
               base::ServoLanes<double>* signals, std::size_t count) {
  step_blocks<double, 32>(constants, blocks, signals, count);
}

void step_avx2(const CurrentLoopConstants<float>& constants, CurrentLoopBlock<float>* blocks,
               base::ServoLanes<float>* signals, std::size_t count) {
  step_blocks<float, 32>(constants, blocks, signals, count);
}

}  // namespace stator::control::current_loop
