#include "stator/control/current_loop/current_loop_batch.hpp"

namespace stator::control {

namespace {

template <typename Number>
CurrentLoopStep<Number> kernel_for(base::InstructionSet instructions) {
  if (instructions == base::InstructionSet::scalar) {
    return current_loop::step_scalar;
  }
#if defined(__x86_64__)
  if (instructions == base::InstructionSet::avx2 && base::supported(instructions)) {
    return current_loop::step_avx2;
  }
  if (instructions == base::InstructionSet::avx512 && base::supported(instructions)) {
    return current_loop::step_avx512;
  }
#endif
  return current_loop::step_baseline;
}

}  // namespace

template <typename Number>
CurrentLoopBatch<Number>::CurrentLoopBatch(const CurrentLoopSettings& settings, std::size_t axes,
                                           base::InstructionSet instructions)
    : blocks_((axes + kLanes - 1) / kLanes), kernel_(kernel_for<Number>(instructions)) {
  constants_.proportional = static_cast<Number>(settings.proportional);
  constants_.integral = static_cast<Number>(settings.integral * settings.period);
  constants_.timer_steps = static_cast<Number>(settings.timer_steps);
  constants_.inverse_timer_steps =
      settings.timer_steps > 0 ? static_cast<Number>(1.0 / settings.timer_steps) : Number{};
}

template <typename Number>
void CurrentLoopBatch<Number>::set_target(std::size_t axis, double direct, double quadrature) {
  CurrentLoopBlock<Number>& block = blocks_[axis / kLanes];
  block.direct_target[axis % kLanes] = static_cast<Number>(direct);
  block.quadrature_target[axis % kLanes] = static_cast<Number>(quadrature);
}

template <typename Number>
void CurrentLoopBatch<Number>::set_voltage(std::size_t axis, double direct, double quadrature) {
  CurrentLoopBlock<Number>& block = blocks_[axis / kLanes];
  block.direct_integral[axis % kLanes] = static_cast<Number>(direct);
  block.quadrature_integral[axis % kLanes] = static_cast<Number>(quadrature);
}

template <typename Number>
void CurrentLoopBatch<Number>::restart(std::size_t axis) {
  set_target(axis, 0.0, 0.0);
  set_voltage(axis, 0.0, 0.0);
}

template <typename Number>
double CurrentLoopBatch<Number>::direct_current(std::size_t axis) const {
  return blocks_[axis / kLanes].direct_current[axis % kLanes];
}

template <typename Number>
double CurrentLoopBatch<Number>::quadrature_current(std::size_t axis) const {
  return blocks_[axis / kLanes].quadrature_current[axis % kLanes];
}

template class CurrentLoopBatch<double>;
template class CurrentLoopBatch<float>;

}  // namespace stator::control
