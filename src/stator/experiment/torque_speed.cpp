// The experiment torque-speed: torque, current and efficiency of a servo motor over speed at a
// constant voltage.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "stator/experiment/measurements.hpp"
#include "stator/experiment/servo_bench.hpp"
#include "stator/experiment/servo_equations.hpp"

namespace stator::experiment {

namespace {

constexpr Option kVoltage{.name = "voltage",
                          .unit = "V",
                          .help =
                              "Voltage on the q axis (peak of a phase); else a third of the "
                              "supply",
                          .minimum = 0.1,
                          .maximum = 1000.0,
                          .preset = {}};
constexpr Option kPoints{.name = "points",
                         .unit = "",
                         .help = "Speeds between standstill and no load at which is measured",
                         .minimum = 3.0,
                         .maximum = 200.0,
                         .preset = 21.0};
constexpr std::array kTorqueSpeedOptions{kVoltage, kPoints, kStep};
constexpr double kRpm = base::kPi / 30.0;
/// kg m^2; a machine that holds the speed.
constexpr double kFlywheel = 1e3;
constexpr double kTimeConstants = 25.0;  ///< L/R, until the current is steady
constexpr double kAveraged = 0.02;       ///< s
/// Of the torque of a blocked shaft; with less the efficiency is that of friction.
constexpr double kWorthwhile = 0.02;

struct Mean {
  double torque = 0.0;
  double quadrature_current = 0.0;
  double power = 0.0;  ///< W from the supply
};

/// The steady state of a motor whose shaft a machine turns at `speed`.
Mean steady_state(plant::ServoAxisParameters axis, double speed, double voltage,
                  base::SimDuration step) {
  axis.load.inertia = kFlywheel;
  CommutatorBench bench(axis, step);
  bench.spin(speed);
  const double time_constant = axis.motor.quadrature_inductance / axis.motor.resistance;
  const auto settling = static_cast<int>(kTimeConstants * time_constant / bench.step());
  for (int n = 0; n < settling; ++n) {
    bench.drive(0.0, voltage);
  }
  const auto averaged = static_cast<int>(kAveraged / bench.step());
  const double energy_before = bench.plant().observe().supplied_energy;
  Mean mean;
  for (int n = 0; n < averaged; ++n) {
    bench.drive(0.0, voltage);
    const plant::ServoAxisObservation seen = bench.plant().observe();
    mean.torque += seen.electromagnetic_torque / averaged;
    mean.quadrature_current += seen.quadrature_current / averaged;
  }
  mean.power =
      (bench.plant().observe().supplied_energy - energy_before) / (averaged * bench.step());
  return mean;
}

/// Speed of the free shaft, rad/s.
double free_speed(const plant::ServoAxisParameters& axis, const ServoEquations& equations,
                  double voltage, base::SimDuration step) {
  CommutatorBench bench(axis, step);
  bench.spin(0.9 * equations.free_speed(voltage));
  constexpr double kRunningUp = 2.0;  // s
  for (auto n = static_cast<int>(kRunningUp / bench.step()); n > 0; --n) {
    bench.drive(0.0, voltage);
  }
  const double before = bench.plant().observe().shaft_angle;
  constexpr double kTime = 0.2;  // s
  const auto steps = static_cast<int>(kTime / bench.step());
  for (int n = 0; n < steps; ++n) {
    bench.drive(0.0, voltage);
  }
  return (bench.plant().observe().shaft_angle - before) / (steps * bench.step());
}

}  // namespace

std::span<const Option> torque_speed_options() {
  return kTorqueSpeedOptions;
}

Result measure_torque_speed(const BenchSetup& setup, const Values& values) {
  const plant::ServoAxisParameters axis = uncoupled(setup.servo);
  const ServoEquations equations(axis);
  const double voltage = values.value_or("voltage", axis.supply_voltage / 3.0);
  const double longest = CommutatorBench::longest_vector(axis.supply_voltage);
  if (voltage > longest) {
    throw ExperimentError(
        fmt::format("torque-speed: {:g} V of supply give a voltage vector of {:.3g} V in every "
                    "direction; choose a lower --voltage or a higher --supply",
                    axis.supply_voltage, longest));
  }
  const base::SimDuration step = microseconds(values["step"]);
  const double no_load = equations.free_speed(voltage);
  const double stall = equations.at(0.0, voltage).torque;
  if (no_load <= 0.0) {
    throw ExperimentError(
        "torque-speed: at this voltage friction holds the shaft; choose a "
        "higher --voltage");
  }
  Panel torque{"speed", "rpm", "motor torque", "N m", {}, {{}, {}}};
  torque.curves = {{"measured", Curve::Style::measured_points, {}},
                   {"Kt (V - ω p ψ) / (R + (ω p L)²/R)", Curve::Style::equation, {}}};
  torque.from_zero = true;
  Panel efficiency{"speed", "rpm", "efficiency", "%", {}, {{}, {}}};
  efficiency.curves = {{"measured", Curve::Style::measured_points, {}},
                       {"ω (T - Tc - B ω) / (3/2 V iq)", Curve::Style::equation, {}}};
  efficiency.from_zero = true;
  Result result;
  result.title =
      fmt::format("Torque and efficiency over speed with {:.3g} V on the q axis", voltage);
  const auto points = static_cast<int>(values["points"]);
  for (int n = 0; n < points; ++n) {
    values.reached(n, points);
    const double speed = no_load * n / (points - 1);
    const ServoEquations::Point expected = equations.at(speed, voltage);
    const Mean seen = steady_state(axis, speed, voltage, step);
    const double shaft =
        seen.torque - equations.coulomb_friction() - equations.viscous_friction() * speed;
    const bool works = speed > 0.0 && expected.shaft_torque > kWorthwhile * stall;
    result.comparisons.push_back({.quantity = fmt::format("torque at {:.0f} rpm", speed / kRpm),
                                  .unit = "N m",
                                  .measured = seen.torque,
                                  .equation = expected.torque,
                                  .scale = works ? 0.0 : stall});
    if (works) {
      result.comparisons.push_back(
          {.quantity = fmt::format("efficiency at {:.0f} rpm", speed / kRpm),
           .unit = "%",
           .measured = 100.0 * shaft * speed / seen.power,
           .equation = 100.0 * expected.efficiency});
    }
    if (n == points / 2) {
      result.comparisons.push_back(
          {.quantity = fmt::format("torque constant at {:.0f} rpm", speed / kRpm),
           .unit = "N m/A",
           .measured = seen.torque / seen.quadrature_current,
           .equation = expected.torque / expected.quadrature_current});
    }
    torque.x.push_back(speed / kRpm);
    torque.curves[0].values.push_back(seen.torque);
    torque.curves[1].values.push_back(expected.torque);
    efficiency.x.push_back(speed / kRpm);
    efficiency.curves[0].values.push_back(100.0 * std::max(0.0, shaft * speed / seen.power));
    efficiency.curves[1].values.push_back(100.0 * std::max(0.0, expected.efficiency));
  }
  result.comparisons.push_back({.quantity = "no-load speed",
                                .unit = "rpm",
                                .measured = free_speed(axis, equations, voltage, step) / kRpm,
                                .equation = no_load / kRpm});
  result.remarks.push_back(
      fmt::format("Kt = 3/2 p ψ = {:.3g} N m/A, R = {:.3g} Ω with the transistors, friction {:.3g} "
                  "N m + {:.3g} N m s/rad ω; a flywheel holds the speed.",
                  equations.torque_constant(), equations.resistance(), equations.coulomb_friction(),
                  equations.viscous_friction()));
  result.panels = {torque, efficiency};
  return result;
}

}  // namespace stator::experiment
