#include "stator/experiment/tuning/tuning_setup.hpp"

#include <string_view>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "stator/plant/motors/stepper_motor.hpp"
#include "stator/plant/motors/three_phase_motor.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/product/catalogue/tuning.hpp"

namespace stator::experiment::tuning {

namespace {

std::vector<std::string> tunable_types(const product::Catalogue& catalogue) {
  std::vector<std::string> types;
  for (const auto& product : catalogue.products()) {
    if (product->tuning() != nullptr) {
      types.push_back(product->identity().type);
    }
  }
  return types;
}

}  // namespace

std::size_t require_tunable(std::span<const BenchDevice> devices, const std::string& device,
                            const std::string& rack, const product::Catalogue& catalogue) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const product::Product& product = devices[i].setup.product();
    if (product.tuning() == nullptr ||
        product.identity().network != product::NetworkKind::segment) {
      continue;
    }
    if (device.empty() || devices[i].name == device) {
      return i;
    }
    names.push_back(devices[i].name);
  }
  const std::vector<std::string> types = tunable_types(catalogue);
  const std::string tunable = fmt::format("{}", fmt::join(types, " or "));
  if (names.empty()) {
    throw ExperimentError(fmt::format("{} has no {}, {} that can be tuned", rack, tunable,
                                      types.size() == 1 ? "the one product" : "the products"));
  }
  throw ExperimentError(fmt::format("{} has no {} called \"{}\"; it has: {}", rack, tunable, device,
                                    fmt::join(names, ", ")));
}

plant::MotorParameters require_motor(const std::string& name) {
  if (const auto motor = plant::find_three_phase_motor(name)) {
    return *motor;
  }
  if (const auto motor = plant::find_stepper_motor(name)) {
    return *motor;
  }
  std::vector<std::string_view> names;
  for (const auto& sheet : plant::three_phase_motor_sheets()) {
    names.push_back(sheet.name);
  }
  for (const auto& sheet : plant::stepper_motor_sheets()) {
    names.push_back(sheet.name);
  }
  throw ExperimentError(
      fmt::format("motor \"{}\" is not known; the motors are: {}", name, fmt::join(names, ", ")));
}

plant::PwmAxisParameters& tuned_axis(product::Setup& setup) {
  return *setup.axes().front().pwm;
}

double rated_current(const plant::MotorParameters& motor) {
  constexpr double kSquareRootOfTwo = 1.41421356237309504880;
  if (const auto* three_phase = std::get_if<plant::ThreePhaseMotorParameters>(&motor)) {
    return three_phase->rated_current;
  }
  if (const auto* stepper = std::get_if<plant::StepperMotorParameters>(&motor)) {
    return kSquareRootOfTwo * stepper->rated_current;
  }
  throw ExperimentError(
      "the motor is a brushed one, which has no field to turn; only three-phase and "
      "two-phase motors can be tuned");
}

Settings settings_of(product::Setup& setup, Settings wishes, std::optional<double> current) {
  const plant::PwmAxisParameters& axis = tuned_axis(setup);
  // Asked for in any case: it tells whether the motor can be tuned.
  const double rated = rated_current(axis.motor);
  wishes.current = current.value_or(rated);
  wishes.motor = std::holds_alternative<plant::StepperMotorParameters>(axis.motor)
                     ? control::foc::MotorType::two_phase
                     : control::foc::MotorType::three_phase;
  const product::TuningBoard board = setup.product().tuning()->board(setup);
  wishes.board = {.counts_per_ampere = board.counts_per_ampere,
                  .counts_per_volt = board.counts_per_volt};
  wishes.pwm_maximum = board.pwm_maximum.value_or(wishes.pwm_maximum);
  return wishes;
}

}  // namespace stator::experiment::tuning
