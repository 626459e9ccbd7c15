#include "stator/plant/motors/three_phase_motor.hpp"

#include <array>

#include "stator/base/trigonometry.hpp"

namespace stator::plant {

namespace {

constexpr double kSquareRootOfThree = 1.73205080756887729353;

// Trinamic QBL4208 manual; maxon catalogue, EC 45 flat 70 W (651614); mjbots mj5208. Friction and
// cogging of the QBL4208 and cogging of the others are estimates for motors of their class.
constexpr auto kPeak = TorqueConstantKind::line_to_line_peak;
constexpr auto kBlock = TorqueConstantKind::block_commutation;
constexpr ThermalParameters kFlat70{.inner_capacity = 6.5,
                                    .outer_capacity = 50.0,
                                    .inner_to_outer = 6.64,
                                    .outer_to_ambient = 2.55};
constexpr std::array kSheets{
    // name                     p   ohm LL  mH LL  mN m/A       g cm^2   A     rpm
    //                          mN m s/rad  mN m  cogging mN m  per revolution  kg
    // clang-format off
    ThreePhaseMotorSheet{"QBL4208-41-04-006", 4, 1.80, 2.60, 35.0, kPeak, 24, 1.79, 4000,
                         0.008, 2.0, 2.5, 24, 0.30},
    ThreePhaseMotorSheet{"QBL4208-61-04-013", 4, 0.72, 1.20, 36.0, kPeak, 48, 3.47, 4000,
                         0.010, 3.0, 4.0, 24, 0.45},
    ThreePhaseMotorSheet{"QBL4208-81-04-019", 4, 0.55, 0.80, 36.0, kPeak, 72, 5.14, 4000,
                         0.012, 3.5, 5.0, 24, 0.65},
    ThreePhaseMotorSheet{"QBL4208-100-04-025", 4, 0.28, 0.54, 36.0, kPeak, 96, 6.95, 4000,
                         0.014, 4.0, 6.0, 24, 0.80},
    ThreePhaseMotorSheet{"EC45-flat-70W", 8, 0.573, 0.301, 40.4, kBlock, 181, 3.29, 4750,
                         0.010, 5.0, 3.0, 48, 0.15, kFlat70},
    ThreePhaseMotorSheet{"mj5208", 7, 0.094, 0.0572, 30.1, kBlock, 560, 20.0, 5000,
                         0.030, 8.0, 5.0, 84, 0.19},
    // clang-format on
};

double flux_linkage(const ThreePhaseMotorSheet& sheet) {
  const double line_to_line =
      sheet.torque_constant * 1e-3 / (kSquareRootOfThree * sheet.pole_pairs);
  return sheet.torque_constant_kind == kPeak ? line_to_line : line_to_line * (base::kPi / 3.0);
}

double rated_loss_when_hot(const ThreePhaseMotorParameters& motor) {
  return 1.5 * motor.resistance * motor.rated_current * motor.rated_current *
         (1.0 + motor.resistance_coefficient * kClassBRise);
}

}  // namespace

std::span<const ThreePhaseMotorSheet> three_phase_motor_sheets() {
  return kSheets;
}

ThreePhaseMotorParameters parameters_of(const ThreePhaseMotorSheet& sheet) {
  ThreePhaseMotorParameters motor;
  motor.pole_pairs = sheet.pole_pairs;
  motor.resistance = 0.5 * sheet.resistance;
  motor.direct_inductance = 0.5e-3 * sheet.inductance;
  motor.quadrature_inductance = motor.direct_inductance;
  motor.flux_linkage = flux_linkage(sheet);
  motor.cogging[0] = {.order = sheet.cogging_per_revolution / sheet.pole_pairs,
                      .amplitude = sheet.cogging_torque * 1e-3};
  motor.rotor_inertia = sheet.rotor_inertia * 1e-7;
  motor.viscous_friction = sheet.viscous_friction * 1e-3;
  motor.coulomb_friction = sheet.coulomb_friction * 1e-3;
  motor.static_friction = 1.2 * motor.coulomb_friction;
  motor.rated_current = sheet.rated_current;
  motor.rated_speed = sheet.rated_speed * (base::kTwoPi / 60.0);
  motor.thermal = sheet.thermal.value_or(class_b_motor(rated_loss_when_hot(motor), sheet.mass));
  return motor;
}

std::optional<ThreePhaseMotorParameters> find_three_phase_motor(std::string_view name) {
  for (const ThreePhaseMotorSheet& sheet : kSheets) {
    if (sheet.name == name) {
      return parameters_of(sheet);
    }
  }
  return std::nullopt;
}

}  // namespace stator::plant
