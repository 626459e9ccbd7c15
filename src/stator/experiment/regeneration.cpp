// The experiment regeneration: a servo motor brakes into its supply, once with and once without the
// brake chopper.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "stator/control/servo/brake_chopper.hpp"
#include "stator/experiment/measurements.hpp"
#include "stator/experiment/servo_bench.hpp"
#include "stator/experiment/servo_equations.hpp"

namespace stator::experiment {

namespace {

constexpr Option kBraking{.name = "current",
                          .unit = "A",
                          .help = "Braking current on the q axis; else the rated one",
                          .minimum = 0.01,
                          .maximum = 1000.0,
                          .preset = {}};
constexpr Option kLimit{.name = "chopper-limit",
                        .unit = "V",
                        .help = "The brake chopper switches on above; else 125 % of the supply",
                        .minimum = 1.0,
                        .maximum = 1000.0,
                        .preset = {}};
constexpr Option kHysteresis{.name = "chopper-hysteresis",
                             .unit = "V",
                             .help = "and off so much below it",
                             .minimum = 0.01,
                             .maximum = 100.0,
                             .preset = 0.5};
constexpr std::array kRegenerationOptions{kBraking, kLimit, kHysteresis, kStep};
constexpr double kRpm = base::kPi / 30.0;
constexpr int kSamples = 400;
constexpr std::array kParts{0.4, 0.6, 0.8, 1.0};  ///< of the time power is returned

/// A drive that brakes its shaft with a constant current.
struct Braking {
  double initial;  ///< rad/s
  double current;  ///< A
  double end;      ///< s, until which power is returned
};

/// Energy that comes back until `time`, J: that of the torque less that of the copper.
double returned_energy(const ServoEquations& equations, const Braking& braking, double time) {
  const double torque = equations.torque_constant() * braking.current;
  return torque * equations.slowing_angle(braking.initial, torque, time) -
         1.5 * equations.resistance() * braking.current * braking.current * time;
}

/// When the copper takes as much as the torque gives.
double end_of_return(const ServoEquations& equations, double initial, double current) {
  const double torque = equations.torque_constant() * current;
  const double last_speed = 1.5 * equations.resistance() * current * current / torque;
  double low = 0.0;
  double high = equations.slowing_time(initial, torque);
  for (int n = 0; n < 60; ++n) {
    const double middle = 0.5 * (low + high);
    (equations.slowing_speed(initial, torque, middle) > last_speed ? low : high) = middle;
  }
  return low;
}

struct Trace {
  std::vector<double> voltage;  ///< V after each step
  double burnt = 0.0;           ///< J in the brake chopper's resistor
};

Trace brake(const plant::ServoAxisParameters& axis, const Braking& braking, base::SimDuration step,
            control::BrakeChopper chopper) {
  CommutatorBench bench(axis, step);
  bench.spin(braking.initial);
  // At speed with no current; the current builds up in a few steps.
  const auto steps = static_cast<int>(std::ceil(braking.end / bench.step()));
  Trace trace;
  for (int n = 0; n < steps; ++n) {
    const bool on = chopper.step(bench.plant().sensing().supply_voltage);
    bench.regulate(-braking.current, on);
    const double voltage = bench.plant().sensing().supply_voltage;
    trace.voltage.push_back(voltage);
    if (on) {
      trace.burnt += bench.step() * voltage * voltage / axis.supply.chopper_resistance;
    }
  }
  return trace;
}

}  // namespace

std::span<const Option> regeneration_options() {
  return kRegenerationOptions;
}

/// The shaft turns at 80 % of the speed its supply allows and is braked with a constant current,
/// once with and once without the brake chopper.
Result measure_regeneration(const BenchSetup& setup, const Values& values) {
  plant::ServoAxisParameters axis = uncoupled(setup.servo);
  axis.supply = setup.servo.supply;
  if (axis.supply.capacitance <= 0.0) {
    throw ExperimentError(
        "regeneration: an ideal source takes everything back; give the supply a capacitance");
  }
  axis.motor.cogging = {};
  axis.supply.chopper_voltage = std::numeric_limits<double>::infinity();
  const ServoEquations equations(axis);
  const double source = axis.supply_voltage;
  const double current = values.value_or("current", axis.motor.rated_current);
  Braking braking{.initial = 0.8 * equations.free_speed(CommutatorBench::longest_vector(source)),
                  .current = current,
                  .end = 0.0};
  braking.end = end_of_return(equations, braking.initial, current);
  const base::SimDuration step = microseconds(values["step"]);
  if (braking.end < 20.0 * step.seconds()) {
    throw ExperimentError(
        "regeneration: with so much current the copper takes all there is to "
        "return; choose a smaller --current or more --inertia");
  }
  control::BrakeChopper chopper;
  const double limit = values.value_or("chopper-limit", 1.25 * source);
  const double hysteresis = values["chopper-hysteresis"];
  const Trace free = brake(axis, braking, step, chopper);
  values.reached(1, 2);
  chopper.configure(true, limit, hysteresis);
  const Trace chopped = brake(axis, braking, step, chopper);

  const double capacitance = axis.supply.capacitance;
  const auto expected = [&](double time) {
    const double energy = std::max(0.0, returned_energy(equations, braking, time));
    return std::sqrt(source * source + 2.0 * energy / capacitance);
  };
  Result result;
  result.title = "Regeneration: the supply while a motor brakes";
  Panel voltage{"time", "ms", "voltage at the power stage", "V", {}, {{}, {}, {}}};
  voltage.curves = {{"measured", Curve::Style::measured_line, {}},
                    {"measured, with brake chopper", Curve::Style::measured_line, {}},
                    {"√(V₀² + 2 E/C)", Curve::Style::equation, {}}};
  const double rise = expected(braking.end) - source;
  for (const double part : kParts) {
    const auto n = static_cast<std::size_t>(part * static_cast<double>(free.voltage.size() - 1));
    const double time = static_cast<double>(n + 1) * step.seconds();
    result.comparisons.push_back({.quantity = fmt::format("voltage after {:.1f} ms", time * 1e3),
                                  .unit = "V",
                                  .measured = free.voltage[n],
                                  .equation = expected(time),
                                  .scale = rise});
  }
  const double highest = *std::ranges::max_element(chopped.voltage);
  const bool chops = highest > limit;
  result.comparisons.push_back({.quantity = "highest voltage with the brake chopper",
                                .unit = "V",
                                .measured = highest,
                                .equation = limit,
                                .judged = chops});
  const double last = chopped.voltage.back();
  const double energy = returned_energy(equations, braking, braking.end);
  const double left = 0.5 * capacitance * (last * last - source * source);
  result.comparisons.push_back({.quantity = "energy burnt in its resistor",
                                .unit = "J",
                                .measured = chopped.burnt,
                                .equation = energy - left,
                                .scale = energy,
                                .judged = chops});
  const std::size_t every = std::max<std::size_t>(1, free.voltage.size() / kSamples);
  for (std::size_t n = 0; n < free.voltage.size(); n += every) {
    const double time = static_cast<double>(n + 1) * step.seconds();
    voltage.x.push_back(time * 1e3);
    voltage.curves[0].values.push_back(free.voltage[n]);
    voltage.curves[1].values.push_back(chopped.voltage[n]);
    voltage.curves[2].values.push_back(expected(time));
  }
  result.remarks.push_back(fmt::format(
      "From {:.0f} rpm with {:.3g} A, J = {:.3g} kg m², C = {:.0f} µF; the chopper switches {:.3g} "
      "Ω on above {:.3g} V, off {:.2g} V below. Shown until the copper takes all the torque gives.",
      braking.initial / kRpm, current, equations.inertia(), capacitance * 1e6,
      axis.supply.chopper_resistance, limit, hysteresis));
  result.panels = {voltage};
  return result;
}

}  // namespace stator::experiment
