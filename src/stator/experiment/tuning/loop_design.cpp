#include "stator/experiment/tuning/loop_design.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "stator/base/trigonometry.hpp"
#include "stator/experiment/tuning/tuning_error.hpp"

namespace stator::experiment::tuning {
namespace {

using control::foc::field;

constexpr double kQ88 = 256.0;
constexpr double kQ015 = 32768.0;
constexpr double kQ412 = 4096.0;
constexpr std::int32_t kLargest = 32767;
constexpr double kRpm = base::kTwoPi / 60.0;     // rad/s
constexpr double kPositionSteps = 65536.0;       // per revolution
constexpr double kLargestShare = 1.0 / 3.0;      // g of a phase margin of 60 degrees
constexpr double kLargestLag = base::kPi / 6.0;  // rad of current loop and meter at crossover

Gain& add_gain(Chip& chip, LoopDesign& design, Gain gain) {
  gain.value = static_cast<std::int32_t>(std::clamp(std::round(gain.wanted), 0.0, 1.0 * kLargest));
  if (gain.value == 0 && gain.name[0] == 'P') {
    throw TuningError(Obstacle::gain_range,
                      fmt::format("gains: {} would be {:.2g} steps of its register ({}), which is "
                                  "none; ask for a higher bandwidth, or a finer current scale",
                                  gain.name, gain.wanted, gain.format));
  }
  if (gain.cut()) {
    design.remarks.push_back(
        fmt::format("{} would have to be {:.4g}; its register ({}) ends at {:.4g}, so the loop is "
                    "slower than wanted.",
                    gain.name, gain.wanted, gain.format, 1.0 * kLargest));
  } else if (std::fabs(gain.error()) > 0.02) {
    design.remarks.push_back(fmt::format("{} is coarse: rounding changes it by {:+.1f} %.",
                                         gain.name, 100.0 * gain.error()));
  }
  chip.set(gain.field, gain.value);
  design.gains.push_back(gain);
  return design.gains.back();
}

/// Raises `value` from `low` to `high` until `reached` says so.
template <typename Reached>
double bisect(double low, double high, const Reached& reached) {
  constexpr int kSteps = 50;
  for (int n = 0; n < kSteps; ++n) {
    const double middle = std::sqrt(low * high);
    (reached(middle) ? high : low) = middle;
  }
  return high;
}

/// g with which the current loop has `bandwidth`.
double current_share(double bandwidth, double period) {
  LoopModel model{.period = period, .current_share = kLargestShare};
  const double highest = bandwidth_of(model, &LoopModel::locked_current);
  if (bandwidth > highest) {
    throw TuningError(Obstacle::bandwidth,
                      fmt::format("gains: {:.4g} Hz of the current loop are more than {:.4g} Hz, "
                                  "which a PWM of {:.4g} kHz allows with 60 degrees of phase "
                                  "margin; lower --current-bandwidth or PWM_MAXCNT",
                                  bandwidth, highest, 1e-3 / period));
  }
  return bisect(1e-5, kLargestShare, [&](double share) {
    model.current_share = share;
    return bandwidth_of(model, &LoopModel::locked_current) >= bandwidth;
  });
}

void add_current_gains(Chip& chip, LoopDesign& design, const Winding& winding, double share) {
  const double period = chip.period();
  const double volt = chip.volt_at(winding.supply.value);
  const auto p = [&](double inductance) {
    return kQ88 * share * inductance / period * chip.ampere() / volt;
  };
  const auto i = [&](double inductance) {
    return kQ015 * period * winding.resistance.value / inductance;
  };
  const double direct = winding.direct_inductance.value;
  const double quadrature = winding.quadrature_inductance.value;
  add_gain(chip, design, {"P flux", "q8.8", field("PID_FLUX_P"), p(direct)});
  add_gain(chip, design, {"I flux", "q0.15", field("PID_FLUX_I"), i(direct)});
  const Gain& torque =
      add_gain(chip, design, {"P torque", "q8.8", field("PID_TORQUE_P"), p(quadrature)});
  design.model.current_share = share * (1.0 + torque.error());
  add_gain(chip, design, {"I torque", "q0.15", field("PID_TORQUE_I"), i(quadrature)});
}

/// Puts velocity gains for a crossover at `angular` rad/s into the model. Returns the lag there of
/// what is neither controller nor inertia, rad.
double set_velocity_gains(LoopModel& model, double angular) {
  constexpr double kLeastDistance = 2.0;
  constexpr double kLargestDistance = 5.0;
  const double frequency = angular / base::kTwoPi;
  const double lag = -std::arg(model.locked_current(frequency) * LoopModel::meter(frequency));
  const double distance = std::clamp(1.0 / std::tan(lag), kLeastDistance, kLargestDistance);
  model.velocity_gain = angular * model.inertia / model.torque_constant;
  model.velocity_integral = angular / distance;
  return lag;
}

void design_velocity(Chip& chip, LoopDesign& design) {
  LoopModel& model = design.model;
  const double highest = 1.0 / model.period;
  const double limit = bisect(0.1, highest, [&](double angular) {
    return set_velocity_gains(model, angular) > kLargestLag;
  });
  set_velocity_gains(model, limit);
  const double possible = bandwidth_of(model, &LoopModel::velocity);
  if (design.wanted_velocity > possible) {
    throw TuningError(
        Obstacle::bandwidth,
        fmt::format("gains: {:.4g} Hz of the velocity loop cannot be had with {:.4g} Hz of the "
                    "current loop and the velocity meter's mean over 0.9 ms; at most {:.4g} Hz, "
                    "lower --velocity-bandwidth",
                    design.wanted_velocity, design.wanted_current, possible));
  }
  const double angular = bisect(0.05, limit, [&](double trial) {
    set_velocity_gains(model, trial);
    return bandwidth_of(model, &LoopModel::velocity) >= design.wanted_velocity;
  });
  set_velocity_gains(model, angular);
  const Gain& p = add_gain(chip, design,
                           {"P velocity", "q8.8", field("PID_VELOCITY_P"),
                            kQ88 * model.velocity_gain * kRpm / chip.ampere()});
  model.velocity_gain *= 1.0 + p.error();
  const Gain& i = add_gain(chip, design,
                           {"I velocity", "q0.15", field("PID_VELOCITY_I"),
                            kQ015 * model.velocity_integral * model.period});
  model.velocity_integral *= 1.0 + i.error();
}

void design_position(Chip& chip, LoopDesign& design) {
  constexpr double kHighestPeak = 1.2;
  LoopModel& model = design.model;
  const double velocity = base::kTwoPi * design.wanted_velocity;
  const auto try_gain = [&](double gain) {
    model.position_gain = gain;
    return bandwidth_of(model, &LoopModel::position);
  };
  const double limit = bisect(1e-3 * velocity, velocity, [&](double gain) {
    model.position_gain = gain;
    return peak_of(model, &LoopModel::position) > kHighestPeak;
  });
  const double possible = try_gain(limit);
  if (design.wanted_position > possible) {
    throw TuningError(
        Obstacle::bandwidth,
        fmt::format("gains: {:.4g} Hz of the position loop ring with {:.4g} Hz of the "
                    "velocity loop; at most {:.4g} Hz, lower --position-bandwidth",
                    design.wanted_position, design.wanted_velocity, possible));
  }
  const double gain = bisect(1e-4 * velocity, limit, [&](double trial) {
    return try_gain(trial) >= design.wanted_position;
  });
  // rpm per 1/65536 of a revolution
  const Gain& p = add_gain(
      chip, design,
      {"P position", "q4.12", field("PID_POSITION_P"), kQ412 * gain * 60.0 / kPositionSteps});
  model.position_gain = gain * (1.0 + p.error());
  chip.set(field("PID_POSITION_I"), 0);
}

}  // namespace

LoopDesign design_current_loops(Chip& chip, const Winding& winding) {
  constexpr double kPreset = 25.0;
  LoopDesign design;
  design.supply = winding.supply.value;
  design.model.period = chip.period();
  design.model.resistance = winding.resistance.value;
  design.model.inductance = winding.quadrature_inductance.value;
  design.wanted_current =
      chip.settings().current_bandwidth.value_or(1.0 / (kPreset * chip.period()));
  add_current_gains(chip, design, winding, current_share(design.wanted_current, chip.period()));
  design.torque_limit = chip.settings().current;
  chip.set(field("PID_TORQUE_FLUX_LIMITS"), std::lround(design.torque_limit / chip.ampere()));
  return design;
}

void design_outer_loops(Chip& chip, const Mechanics& mechanics, LoopDesign& design) {
  constexpr double kVelocityPreset = 0.05;
  constexpr double kPositionPreset = 0.2;
  const Settings& settings = chip.settings();
  design.wanted_velocity =
      settings.velocity_bandwidth.value_or(kVelocityPreset * design.wanted_current);
  design.wanted_position =
      settings.position_bandwidth.value_or(kPositionPreset * design.wanted_velocity);
  design.model.torque_constant = mechanics.torque_constant;
  design.model.emf_constant = mechanics.torque_constant / chip.torque_factor();
  design.model.inertia = mechanics.inertia.value;
  design.model.viscous_friction = std::max(mechanics.viscous_friction.value, 0.0);
  design_velocity(chip, design);
  design_position(chip, design);
  // 90 % of the speed at which the EMF takes all the voltage.
  const double electrical =
      0.9 * 32767.0 * chip.volt_at(design.supply) / mechanics.flux_linkage.value;
  const double poles =
      mechanics.torque_constant / (chip.torque_factor() * mechanics.flux_linkage.value);
  design.velocity_limit = std::floor(electrical / poles / kRpm);
  chip.set(field("PID_VELOCITY_LIMIT"), std::lround(design.velocity_limit));
}

}  // namespace stator::experiment::tuning
