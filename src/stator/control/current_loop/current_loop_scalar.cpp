// The current loops without vectors, a lane at a time: the reference for all other instruction
// sets.
#include "stator/control/current_loop/current_loop_kernel.hpp"

namespace stator::control::current_loop {

void step_scalar(const CurrentLoopConstants<double>& constants, CurrentLoopBlock<double>* blocks,
                 base::ServoLanes<double>* signals, std::size_t count) {
  step_blocks<double, 8>(constants, blocks, signals, count);
}

void step_scalar(const CurrentLoopConstants<float>& constants, CurrentLoopBlock<float>* blocks,
                 base::ServoLanes<float>* signals, std::size_t count) {
  step_blocks<float, 4>(constants, blocks, signals, count);
}

}  // namespace stator::control::current_loop
