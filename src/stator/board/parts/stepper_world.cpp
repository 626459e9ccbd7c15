#include "stator/board/parts/stepper_world.hpp"

#include <stdexcept>

namespace stator::board {

namespace {

plant::StepperAxisParameters axis_of(const Settings& settings) {
  plant::StepperAxisParameters parameters;
  const auto motor = plant::find_stepper_motor(settings.text("motor"));
  if (!motor) {
    std::string names;
    for (const plant::StepperMotorSheet& sheet : plant::stepper_motor_sheets()) {
      names += (names.empty() ? "" : ", ") + std::string(sheet.name);
    }
    throw std::invalid_argument("there is no stepper motor \"" + settings.text("motor") +
                                "\"; there are: " + names);
  }
  parameters.motor = *motor;
  parameters.supply_voltage = settings.number("supply_voltage");
  parameters.load = load_of(settings);
  parameters.encoder.counts_per_revolution = 0;
  return parameters;
}

}  // namespace

plant::MechanicalLoad load_of(const Settings& settings) {
  plant::MechanicalLoad load;
  load.inertia = settings.number("load_inertia");
  load.coulomb_friction = settings.number("load_friction");
  load.constant_torque = settings.number("load_torque");
  if (settings.number("end_stop_minimum") > kMinimumStop.value) {
    load.end_stop_minimum = settings.number("end_stop_minimum");
  }
  if (settings.number("end_stop_maximum") < kMaximumStop.value) {
    load.end_stop_maximum = settings.number("end_stop_maximum");
  }
  if (load.end_stop_minimum >= load.end_stop_maximum) {
    throw std::invalid_argument(R"("end_stop_minimum" must lie below "end_stop_maximum")");
  }
  return load;
}

StepperWorld::StepperWorld(const Settings& settings) : axis_(axis_of(settings)) {
  shaft_.place(position());
}

bool StepperWorld::step(const base::AxisActuation& actuation, base::SimTime now) {
  for (; computed_to_ < now; computed_to_ += kPeriod) {
    axis_.step(latest_, kPeriod);
  }
  const plant::HybridStepperState before = axis_.state().motor;
  const base::SimTime begin = computed_to_;
  axis_.step(actuation, kPeriod);
  computed_to_ += kPeriod;
  const bool changed = axis_.state().motor != before || actuation != latest_;
  latest_ = actuation;
  if (axis_.state().motor.angle != before.angle) {
    shaft_.move({begin, kPeriod, shaft_.position(), position()});
  }
  return changed;
}

ShaftPosition StepperWorld::position() const {
  const plant::ElectricalAngle& angle = axis_.state().motor.angle;
  const std::int64_t pole_pairs = axis_.parameters().motor.pole_pairs;
  std::int64_t turns = angle.periods / pole_pairs;
  std::int64_t rest = angle.periods % pole_pairs;
  if (rest < 0) {
    rest += pole_pairs;
    --turns;
  }
  const double within = static_cast<double>(rest) + angle.angle / base::kTwoPi;
  return {turns, within / static_cast<double>(pole_pairs)};
}

double StepperWorld::speed() const {
  return axis_.state().motor.speed * (60.0 / base::kTwoPi);
}

double StepperWorld::load_angle() const {
  return axis_.observe().load_angle * (180.0 / base::kPi);
}

void StepperWorld::append_signals(std::vector<base::Signal>& signals) const {
  using Read = base::SignalReader;
  signals.push_back({"position", "rev", Read::bind<&StepperWorld::revolutions>(*this)});
  signals.push_back({"speed", "1/min", Read::bind<&StepperWorld::speed>(*this)});
  signals.push_back({"load_angle", "degree", Read::bind<&StepperWorld::load_angle>(*this)});
  signals.push_back({"current_a", "A", Read::bind<&StepperWorld::current_a>(*this)});
  signals.push_back({"current_b", "A", Read::bind<&StepperWorld::current_b>(*this)});
}

void StepperWorld::set_load_torque(double torque) {
  axis_.set_external_torque(torque);
}

void StepperWorld::set_supply(double voltage) {
  axis_.set_supply_voltage(voltage);
}

}  // namespace stator::board
