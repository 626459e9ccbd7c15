#include "stator/board/parts/stepper_peripheral.hpp"

namespace stator::board {

void StepperPeripheral::advance(base::SimTime now) {
  const std::optional<StepCount> count = count_steps(*this);
  if (count && count->steps != 0) {
    make_steps(now, count->steps);
  }
  const bool running = count && count->running;
  awake_ = world_.step(actuation(now), now) || running;
  if (awake_) {
    schedule(now + StepperWorld::kPeriod);
  }
}

std::vector<base::Signal> StepperPeripheral::signals() const {
  std::vector<base::Signal> result;
  world_.append_signals(result);
  return result;
}

std::vector<base::Input> StepperPeripheral::inputs() {
  using Group = base::InputGroup;
  using Set = base::Delegate<void(double)>;
  std::vector<base::Input> result{
      {"load_torque", "Nm", -1e3, 1e3, Set::bind<&StepperPeripheral::set_load_torque>(*this),
       Group::load},
      {"supply_voltage", "V", 0.0, 100.0, Set::bind<&StepperPeripheral::set_supply>(*this),
       Group::supply, world_.axis().parameters().supply_voltage},
      {"open_a", "", 0.0, 1.0, Set::bind<&StepperPeripheral::open_a>(*this), Group::driver},
      {"open_b", "", 0.0, 1.0, Set::bind<&StepperPeripheral::open_b>(*this), Group::driver},
      {"short_a", "", 0.0, 1.0, Set::bind<&StepperPeripheral::short_a>(*this), Group::driver},
      {"short_b", "", 0.0, 1.0, Set::bind<&StepperPeripheral::short_b>(*this), Group::driver},
  };
  fault_inputs_.append(result, "");
  return result;
}

}  // namespace stator::board
