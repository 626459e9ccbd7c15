// The current loops compiled for AVX-512: eight doubles or sixteen floats at once.
#include "stator/control/current_loop/current_loop_kernel.hpp"

namespace stator::control::current_loop {

void step_avx512(const CurrentLoopConstants<double>& constants, CurrentLoopBlock<double>* blocks,
                 base::ServoLanes<double>* signals, std::size_t count) {
  step_blocks<double, 64>(constants, blocks, signals, count);
}

void step_avx512(const CurrentLoopConstants<float>& constants, CurrentLoopBlock<float>* blocks,
                 base::ServoLanes<float>* signals, std::size_t count) {
  step_blocks<float, 64>(constants, blocks, signals, count);
}

}  // namespace stator::control::current_loop
