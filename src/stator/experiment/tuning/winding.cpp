#include "stator/experiment/tuning/winding.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "stator/base/trigonometry.hpp"
#include "stator/experiment/tuning/statistics.hpp"
#include "stator/experiment/tuning/tuning_error.hpp"

namespace stator::experiment::tuning {
namespace {

using control::foc::field;
using control::foc::MotorType;

constexpr std::int32_t kLargestVoltage = 31'000;
constexpr std::int32_t kMiddle = 32'768;

/// A phase with the direction of the field in which it carries most.
struct Phase {
  const char* name;
  int number;
  std::int32_t phi;
};

std::vector<Phase> phases_of(MotorType motor) {
  if (motor == MotorType::two_phase) {
    return {{"X", 0, 0}, {"Y", 2, 0x4000}};
  }
  return {{"U", 0, 0}, {"V", 1, 0x5555}, {"W", 2, -0x5555}};
}

double largest_current(const Chip& chip) {
  double largest = 0.0;
  for (const int phase : {0, 1, 2}) {
    largest = std::max(largest, std::fabs(chip.phase_current(phase)));
  }
  return largest;
}

struct Point {
  double voltage = 0.0;  ///< V
  Measured current;
};

/// Current along the field with `voltage` of U_D when all has settled.
Point settled(Chip& chip, std::int32_t voltage) {
  constexpr double kSettle = 0.1;    // s
  constexpr double kAverage = 0.08;  // s
  constexpr int kDither = 256;
  constexpr int kOddStep = 37;
  chip.set_voltage(voltage);
  chip.run(kSettle);
  wait_for_rest(chip, 1.0);
  Mean current;
  Mean supply;
  const int periods = chip.periods(kAverage);
  Mean applied;
  for (int k = 0; k < periods; ++k) {
    // Steps of the PWM timer are wider than those of the voltage: all remainders in turn.
    const std::int32_t dithered = voltage + k * kOddStep % kDither;
    chip.set_voltage(dithered);
    chip.step();
    const Sample sample = chip.sample();
    applied.add(dithered);
    current.add(sample.id);
    supply.add(sample.supply);
  }
  return {applied.value() * chip.volt_at(supply.value()), current.measured()};
}

/// Between two phases of three, where no current is so small that ripple reverses it: there dead
/// time does not drop out.
Measured resistance_along(Chip& chip, const Phase& phase) {
  constexpr std::int32_t kBetween = 0x1555;  // 30 degrees
  constexpr double kLow = 0.6;
  const bool between = chip.settings().motor == MotorType::three_phase;
  const std::int32_t voltage =
      raise_current(chip, phase.phi + (between ? kBetween : 0), 0.866 * chip.settings().current);
  const Point high = settled(chip, voltage);
  const Point low = settled(chip, static_cast<std::int32_t>(kLow * voltage));
  const double difference = high.current.value - low.current.value;
  const double resistance = (high.voltage - low.voltage) / difference;
  return {resistance,
          resistance * std::hypot(high.current.deviation, low.current.deviation) / difference};
}

/// Sign with which the channel of a phase shows a current into it; 0 if none flows.
int sign_of(Chip& chip, const Phase& phase) {
  const double wanted = chip.settings().current;
  const std::int32_t voltage = raise_current(chip, phase.phi, wanted);
  const double seen = chip.phase_current(phase.number);
  const double largest = largest_current(chip);
  chip.set_voltage(0);
  if (voltage == 0 && largest > 0.05 * wanted) {
    throw TuningError(
        Obstacle::supply_too_low,
        fmt::format(
            "resistance: {:.3g} V drive only {:.3g} A through phase {}, not {:.3g} A; choose "
            "a lower --current or a higher supply",
            chip.supply(), largest, phase.name, wanted));
  }
  return voltage == 0 ? 0 : (seen < 0.0 ? -1 : 1);
}

void check_phases(const std::vector<Phase>& phases, const std::vector<int>& signs) {
  std::vector<std::string_view> open;
  for (std::size_t k = 0; k < phases.size(); ++k) {
    if (signs[k] == 0) {
      open.emplace_back(phases[k].name);
    }
  }
  if (open.size() == phases.size()) {
    throw TuningError(
        Obstacle::no_motor,
        "resistance: no phase carries current at full voltage; connect the motor, and "
        "see that the power stage is enabled and the current is measured");
  }
  if (!open.empty()) {
    throw TuningError(
        Obstacle::phase_open,
        fmt::format("resistance: phase {} carries no current while others do; look at "
                    "its wire, its half bridge and its current channel",
                    fmt::join(open, " and ")));
  }
  if (signs.front() != signs.back()) {
    throw TuningError(Obstacle::current_sensing,
                      fmt::format("resistance: the current channels of phase {} and phase {} have "
                                  "different signs; exchange the two wires of one amplifier",
                                  phases.front().name, phases.back().name));
  }
}

/// Sine of an amplitude (register steps) added to a voltage along the field.
struct Injection {
  static constexpr int kPerCycle = 16;

  std::int32_t bias;
  bool across;
  double amplitude;

  /// A/V of the answer over `cycles`, and the current's amplitude.
  struct Answer {
    double admittance;
    double current;
  };
  Answer measure(Chip& chip, int cycles) const {
    std::array<double, 2> voltage{};
    std::array<double, 2> current{};
    for (int k = 0; k < cycles * kPerCycle; ++k) {
      const base::SineCosine z = base::sine_cosine(base::kTwoPi * (k % kPerCycle) / kPerCycle);
      const auto added = static_cast<std::int32_t>(std::lround(amplitude * z.sine));
      chip.set_voltage(across ? bias : bias + added, across ? added : 0);
      chip.step();
      const Sample sample = chip.sample();
      const double applied = across ? sample.uq : sample.ud;
      const double seen = across ? sample.iq : sample.id;
      voltage = {voltage[0] + applied * z.cosine, voltage[1] + applied * z.sine};
      current = {current[0] + seen * z.cosine, current[1] + seen * z.sine};
    }
    const double length = std::hypot(current[0], current[1]);
    return {length / std::hypot(voltage[0], voltage[1]), 2.0 * length / (cycles * kPerCycle)};
  }
};

/// L of i(k+1) = a i(k) + (1 - a) / R u(k), a = exp(-R T / L), whose gain at a 16th of the PWM
/// frequency is `admittance`.
double inductance_of(double admittance, double resistance, double period) {
  const base::SineCosine z = base::sine_cosine(base::kTwoPi / Injection::kPerCycle);
  double low = 0.0;
  double high = 1.0;
  for (int n = 0; n < 60; ++n) {
    const double a = 0.5 * (low + high);
    const double gain = (1.0 - a) / (resistance * std::hypot(z.cosine - a, z.sine));
    (gain > admittance ? low : high) = a;
  }
  return -resistance * period / std::log(0.5 * (low + high));
}

Measured inductance(Chip& chip, std::int32_t bias, bool across, double resistance) {
  constexpr int kSettle = 60;   // cycles
  constexpr int kCycles = 100;  // of each block
  constexpr int kBlocks = 6;
  const double room = across
                          ? std::sqrt(1.0 * kLargestVoltage * kLargestVoltage - 1.0 * bias * bias)
                          : kLargestVoltage - bias;
  Injection injection{.bias = bias, .across = across, .amplitude = std::min(300.0, room)};
  for (int n = 0; n < 4; ++n) {
    const double seen = injection.measure(chip, kSettle).current;
    const double wanted = 0.2 * chip.settings().current;
    const double factor = std::clamp(wanted / std::max(seen, chip.ampere()), 0.2, 8.0);
    injection.amplitude = std::min(injection.amplitude * factor, room);
  }
  injection.measure(chip, kSettle);
  Mean result;
  for (int n = 0; n < kBlocks; ++n) {
    result.add(
        inductance_of(injection.measure(chip, kCycles).admittance, resistance, chip.period()));
  }
  chip.set_voltage(bias);
  return result.measured();
}

}  // namespace

void wait_for_rest(Chip& chip, double longest) {
  constexpr double kStill = 0.03;  // s
  const int still = chip.periods(kStill);
  int waited = 0;
  std::int64_t count = chip.count();
  for (int left = chip.periods(longest); left > 0 && waited < still; --left) {
    chip.step();
    waited = chip.count() == count ? waited + 1 : 0;
    count = chip.count();
  }
}

std::int32_t raise_current(Chip& chip, std::int32_t phi, double current) {
  constexpr double kGrowth = 1.02;
  constexpr double kStep = 1e-3;  // s
  chip.hold_field(phi);
  double voltage = 32.0;
  while (voltage < kLargestVoltage) {
    const auto applied = static_cast<std::int32_t>(voltage);
    chip.set_voltage(applied);
    chip.run(kStep);
    if (largest_current(chip) >= current) {
      return applied;
    }
    voltage *= kGrowth;
  }
  return 0;
}

void measure_offsets(Chip& chip, Winding& winding) {
  constexpr double kLowestSupply = 6.0;  // V; gate drivers need more
  constexpr double kAverage = 0.1;       // s
  constexpr double kFarthest = 8'192.0;  // counts from the middle
  chip.enable(false);
  chip.run(0.02);  // currents decay
  std::array<Mean, 2> raw;
  Mean supply;
  for (int left = chip.periods(kAverage); left > 0; --left) {
    chip.step();
    raw[0].add(chip.get(field("ADC_I0_RAW")));
    raw[1].add(chip.get(field("ADC_I1_RAW")));
    supply.add(chip.supply());
  }
  winding.supply = supply.measured();
  winding.offsets = {raw[0].measured(), raw[1].measured()};
  if (winding.supply.value < kLowestSupply) {
    throw TuningError(
        Obstacle::supply_too_low,
        fmt::format("offsets: the supply is {:.3g} V, less than {:g} V; switch it on, "
                    "or correct the counts per volt of its converter",
                    winding.supply.value, kLowestSupply));
  }
  for (const Measured& offset : winding.offsets) {
    if (std::fabs(offset.value - kMiddle) > kFarthest) {
      throw TuningError(Obstacle::current_sensing,
                        fmt::format("offsets: a current channel shows {:.0f} without current, far "
                                    "from the middle of its range at {}; look at its amplifier",
                                    offset.value, kMiddle));
    }
    const double room = (kMiddle - std::fabs(offset.value - kMiddle)) * chip.ampere();
    if (1.3 * chip.settings().current > room) {
      throw TuningError(
          Obstacle::current_range,
          fmt::format("offsets: the current converters reach to {:.3g} A; {:.3g} A leave no room "
                      "for overshoot, choose a --current of at most {:.3g} A",
                      room, chip.settings().current, room / 1.3));
    }
  }
  chip.set(field("ADC_I0_OFFSET"), std::lround(winding.offsets[0].value));
  chip.set(field("ADC_I1_OFFSET"), std::lround(winding.offsets[1].value));
  chip.take_clipped();
}

void measure_resistance(Chip& chip, Winding& winding) {
  const std::vector<Phase> phases = phases_of(chip.settings().motor);
  std::vector<int> signs;
  signs.reserve(phases.size());
  for (const Phase& phase : phases) {
    signs.push_back(sign_of(chip, phase));
  }
  check_phases(phases, signs);
  winding.current_scale *= signs.front();
  chip.set(field("ADC_I0_SCALE"), winding.current_scale);
  chip.set(field("ADC_I1_SCALE"), winding.current_scale);
  Mean resistance;
  double noise = 0.0;
  for (const Phase& phase : phases) {
    const Measured along = resistance_along(chip, phase);
    resistance.add(along.value);
    noise = std::max(noise, along.deviation);
  }
  winding.resistance = {resistance.value(), std::hypot(resistance.deviation(), noise)};
}

void measure_inductances(Chip& chip, Winding& winding) {
  const std::int32_t bias = raise_current(chip, 0, chip.settings().current);
  wait_for_rest(chip, 1.0);
  const double resistance = winding.resistance.value;
  winding.direct_inductance = inductance(chip, bias, false, resistance);
  winding.quadrature_inductance = inductance(chip, bias, true, resistance);
  if (chip.take_clipped()) {
    throw TuningError(Obstacle::current_range,
                      "inductance: a current left the range of its converter; choose a lower "
                      "--current");
  }
}

}  // namespace stator::experiment::tuning
