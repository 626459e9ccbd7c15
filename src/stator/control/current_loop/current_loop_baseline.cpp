// The current loops for the vectors that every processor of the target has: two doubles or four
// floats at once.
#include "stator/control/current_loop/current_loop_kernel.hpp"

namespace stator::control::current_loop {

void step_baseline(const CurrentLoopConstants<double>& constants, CurrentLoopBlock<double>* blocks,
                   base::ServoLanes<double>* signals, std::size_t count) {
  step_blocks<double, 16>(constants, blocks, signals, count);
}

void step_baseline(const CurrentLoopConstants<float>& constants, CurrentLoopBlock<float>* blocks,
                   base::ServoLanes<float>* signals, std::size_t count) {
  step_blocks<float, 16>(constants, blocks, signals, count);
}

}  // namespace stator::control::current_loop
