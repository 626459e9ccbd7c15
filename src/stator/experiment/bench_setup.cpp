#include "stator/experiment/bench_setup.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "stator/plant/motors/stepper_motor.hpp"
#include "stator/plant/motors/three_phase_motor.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/product/device/axis_bench.hpp"
#include "stator/settings/words.hpp"

namespace stator::experiment {

namespace {

using Stepper = plant::StepperAxisParameters;
using Servo = plant::ServoAxisParameters;

constexpr std::array kAxisQuantities{
    AxisQuantity{"supply", "V", "Supply of the power stage", 0.1, 100.0,
                 [](Stepper& axis) -> double& { return axis.supply_voltage; },
                 [](Servo& axis) -> double& { return axis.supply_voltage; }},
    AxisQuantity{"inertia", "kg m2", "Inertia of the load, at the motor shaft", 0.0, 10.0,
                 [](Stepper& axis) -> double& { return axis.load.inertia; },
                 [](Servo& axis) -> double& { return axis.load.inertia; }},
    AxisQuantity{"viscous-friction", "N m s/rad", "Viscous friction of the load", 0.0, 10.0,
                 [](Stepper& axis) -> double& { return axis.load.viscous_friction; },
                 [](Servo& axis) -> double& { return axis.load.viscous_friction; }},
    AxisQuantity{"coulomb-friction", "N m", "Dry friction of the load", 0.0, 1000.0,
                 [](Stepper& axis) -> double& { return axis.load.coulomb_friction; },
                 [](Servo& axis) -> double& { return axis.load.coulomb_friction; }},
    AxisQuantity{"load-torque", "N m", "Constant torque against forward motion", -1000.0, 1000.0,
                 [](Stepper& axis) -> double& { return axis.load.constant_torque; },
                 [](Servo& axis) -> double& { return axis.load.constant_torque; }, true}};

/// The motor called `name` of those on `sheets`.
template <typename Sheets, typename Motor>
Motor motor_named(const std::string& name, const Sheets& sheets,
                  const std::optional<Motor>& motor) {
  if (motor) {
    return *motor;
  }
  std::set<std::string> names;
  for (const auto& sheet : sheets) {
    names.emplace(sheet.name);
  }
  throw ExperimentError(fmt::format("motor \"{}\" is not known{}; the motors are: {}", name,
                                    settings::guess_text(name, names), settings::joined(names)));
}

BenchSetup setup_of_device(BenchDevice& device, MotorKind kind, unsigned axis) {
  const std::vector<product::AxisSetup> axes = device.setup.axes();
  const product::AxisSetup found = axis < axes.size() ? axes[axis] : product::AxisSetup{};
  BenchSetup setup;
  if (kind == MotorKind::three_phase) {
    if (found.servo == nullptr) {
      throw ExperimentError(fmt::format(
          "{} has no axis {} with a three-phase motor; see \"stator devices\"", device.name, axis));
    }
    setup.servo = *found.servo;
    return setup;
  }
  if (found.stepper == nullptr || found.full_scale_current == 0.0) {
    throw ExperimentError(fmt::format(
        "{} has no axis {} with a stepper motor; see \"stator devices\"", device.name, axis));
  }
  setup.axis = *found.stepper;
  setup.full_scale_current = found.full_scale_current;
  return setup;
}

}  // namespace

BenchSetup setup_of_axis(std::vector<BenchDevice> devices, MotorKind kind, const BenchAxis& asked) {
  if (kind == MotorKind::three_phase) {
    std::stable_partition(devices.begin(), devices.end(), [](const BenchDevice& device) {
      return device.setup.product().identity().network == product::NetworkKind::bus;
    });
  }
  std::set<std::string> names;
  for (BenchDevice& device : devices) {
    names.insert(device.name);
    if (asked.device.empty() || device.name == asked.device) {
      return setup_of_device(device, kind, asked.axis);
    }
  }
  throw ExperimentError(fmt::format("{} has no device \"{}\"; it has: {}", asked.rack, asked.device,
                                    settings::joined(names)));
}

void change_motor(const std::string& name, MotorKind kind, BenchSetup& setup) {
  if (kind == MotorKind::three_phase) {
    setup.servo.motor =
        motor_named(name, plant::three_phase_motor_sheets(), plant::find_three_phase_motor(name));
  } else {
    setup.axis.motor =
        motor_named(name, plant::stepper_motor_sheets(), plant::find_stepper_motor(name));
  }
}

std::span<const AxisQuantity> axis_quantities() {
  return kAxisQuantities;
}

void change_quantity(const AxisQuantity& quantity, double value, std::string_view called,
                     BenchSetup& setup) {
  if (!(value >= quantity.minimum && value <= quantity.maximum)) {
    throw ExperimentError(fmt::format("{} is {} {}; it must lie in {} .. {}", called, value,
                                      quantity.unit, quantity.minimum, quantity.maximum));
  }
  const double set = quantity.against ? -value : value;
  quantity.of_stepper(setup.axis) = set;
  quantity.of_servo(setup.servo) = set;
}

std::shared_ptr<const product::Product> module_for_bench(const product::Catalogue& catalogue) {
  const BenchSetup any;
  for (const auto& product : catalogue.products()) {
    if (product->axis_bench(any.axis, any.full_scale_current) != nullptr) {
      return product;
    }
  }
  return nullptr;
}

}  // namespace stator::experiment
