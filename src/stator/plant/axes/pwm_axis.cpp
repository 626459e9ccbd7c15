#include "stator/plant/axes/pwm_axis.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include "stator/plant/power/switched_inverter.hpp"
#include "stator/plant/power/switched_turn.hpp"

namespace stator::plant {

namespace {

/// Temperatures advance, and rounding errors of small rotations are removed, so often; the fastest
/// time constant of the thermal models is near a second.
constexpr base::SimDuration kThermalPeriod{10'000'000};

const ThermalParameters& thermal_of(const MotorParameters& motor) {
  return std::visit([](const auto& kind) -> const ThermalParameters& { return kind.thermal; },
                    motor);
}

int pole_pairs_of(const MotorParameters& motor) {
  if (const auto* three_phase = std::get_if<ThreePhaseMotorParameters>(&motor)) {
    return three_phase->pole_pairs;
  }
  if (const auto* stepper = std::get_if<StepperMotorParameters>(&motor)) {
    return stepper->pole_pairs;
  }
  return 1;
}

}  // namespace

PwmAxis::Winding PwmAxis::winding_of(const PwmAxisParameters& p) {
  const double start = p.initial_revolutions;
  if (const auto* three_phase = std::get_if<ThreePhaseMotorParameters>(&p.motor)) {
    return ThreePhaseWinding(*three_phase, p.load, p.inverter, start);
  }
  if (const auto* stepper = std::get_if<StepperMotorParameters>(&p.motor)) {
    return TwoPhaseWinding(*stepper, p.load, p.inverter, start);
  }
  return DcWinding(*std::get_if<DcMotorParameters>(&p.motor), p.load, p.inverter, start);
}

PwmAxis::PwmAxis(const PwmAxisParameters& p)
    : parameters_(p),
      winding_(winding_of(p)),
      supply_(p.supply),
      supply_state_{.source = p.supply_voltage, .voltage = p.supply_voltage},
      motor_thermal_(thermal_of(p.motor), kThermalPeriod.seconds()),
      stage_thermal_(p.inverter.thermal, kThermalPeriod.seconds()),
      motor_temperature_{p.ambient_temperature, p.ambient_temperature},
      stage_temperature_{p.ambient_temperature, p.ambient_temperature},
      ambient_temperature_(p.ambient_temperature),
      has_switches_(p.left_switch.fitted || p.right_switch.fitted || p.home_switch.fitted),
      converter_(p.converter),
      halls_(p.halls),
      inverter_(p.inverter),
      dead_time_(p.inverter, 1.0, 1.0),
      analog_halls_(p.analog_halls, pole_pairs_of(p.motor)),
      analog_encoder_(p.analog_encoder, pole_pairs_of(p.motor)),
      encoders_{IncrementalEncoder(p.encoders[0], pole_pairs_of(p.motor)),
                IncrementalEncoder(p.encoders[1], pole_pairs_of(p.motor))},
      disturbances_{EncoderDisturbance(p.encoder_disturbances[0], pole_pairs_of(p.motor)),
                    EncoderDisturbance(p.encoder_disturbances[1], pole_pairs_of(p.motor))},
      converter_noise_(p.noise_seed),
      angle_noise_(p.noise_seed + 1) {
  brake_.open = p.brake.closed_by_current;
  fault_state_.supply_voltage = p.supply_voltage;
  sensing_.driver_temperature = sensing_.winding_temperature = p.ambient_temperature;
  constexpr double kAnyPeriod = 1.0;
  std::visit(
      [&](auto& winding) {
        winding.set_temperatures(motor_temperature_);
        for (std::size_t k = 0; k < encoders_.size(); ++k) {
          disturbance_states_[k].random = base::Random(p.noise_seed + 2 + k);
          encoder_states_[k] = encoders_[k].power_on(disturbances_[k].seen(winding.angle()));
        }
        hall_levels_ = halls_.power_on(winding.direction());
        sense(winding, kAnyPeriod);
      },
      winding_);
  sense_switches();
}

template <typename Of>
[[gnu::always_inline]] inline double PwmAxis::pass(Of& winding, const PwmActuation& actuation,
                                                   double period) {
  if (!actuation.bridge_enabled) {
    const double energy = winding.coast(supply_state_.voltage, shaft_, period);
    supply_.draw(supply_state_, energy / period, period, actuation.brake_chopper_on);
    return energy;
  }
  typename Of::Values duty{};
  for (std::size_t k = 0; k < Of::kBridges; ++k) {
    duty[k] = std::clamp(actuation.duty[k], 0.0, 1.0);
  }
  if (faulty_) [[unlikely]] {
    for (std::size_t k = 0; k < Of::kBridges; ++k) {
      duty[k] = faults_.terminals.grounded[k] || faults_.high_side ? 0.0 : duty[k];
    }
  }
  if (parameters_.inverter_model == InverterModel::switched) {
    if constexpr (std::is_same_v<Of, ThreePhaseWinding>) {
      const std::optional<double> energy =
          turn_switched(winding, inverter_, supply_, supply_state_, duty, shaft_,
                        actuation.brake_chopper_on, period);
      if (energy) [[likely]] {
        return *energy;
      }
    }
    return switch_period(winding, inverter_, supply_, supply_state_, duty, shaft_,
                         actuation.brake_chopper_on, period);
  }
  return average_period(winding, inverter_.dead_time > 0.0 ? &dead_time_ : nullptr, supply_,
                        supply_state_, duty, shaft_, actuation.brake_chopper_on, period);
}

void PwmAxis::set_period(base::SimDuration period, double dead_time) {
  const double inductance =
      std::visit([](const auto& winding) { return winding.inductance(); }, winding_);
  period_ = period;
  period_seconds_ = period.seconds();
  commanded_dead_time_ = dead_time;
  inverter_.pwm_frequency = 1.0 / period_seconds_;
  inverter_.dead_time = std::max(parameters_.inverter.dead_time, dead_time);
  dead_time_ = DeadTime(inverter_, inductance, period_seconds_);
}

const PwmSensing& PwmAxis::step(const PwmActuation& actuation, base::SimDuration period) {
  parameters_.brake.advance(brake_, actuation.brake_released, period);
  shaft_.brake_engaged = !brake_.open;
  unheated_ += period;
  if (period != period_ || actuation.dead_time != commanded_dead_time_) [[unlikely]] {
    set_period(period, actuation.dead_time);
  }
  const double seconds = period_seconds_;
  std::visit(
      [&](auto& winding) {
        period_energy_ = pass(winding, actuation, seconds);
        bridge_energy_ += period_energy_;
        square_current_ += seconds * winding.square_current();
        if (unheated_ >= kThermalPeriod) [[unlikely]] {
          update_temperatures(winding);
          winding.refresh();
        }
        sense(winding, seconds);
      },
      winding_);
  if (has_switches_) {
    sense_switches();
  }
  if (faulty_) [[unlikely]] {
    sense_faults(actuation.bridge_enabled);
  }
  return sensing_;
}

template <typename Of>
void PwmAxis::update_temperatures(Of& winding) {
  const double mean_square = square_current_ / unheated_.seconds();
  const InverterParameters& inverter = parameters_.inverter;
  const double of_terminals = Of::kTerminalsPerPhase * mean_square;
  const HeatFaults& heat = faults_.common.heat;
  const double stage_loss =
      inverter.on_resistance * of_terminals +
      inverter.switching_share * supply_state_.voltage * std::sqrt(of_terminals) + heat.driver_heat;
  const double motor_loss = winding.resistance() * mean_square + heat.motor_heat;
  for (; unheated_ >= kThermalPeriod; unheated_ = unheated_ - kThermalPeriod) {
    motor_thermal_.advance(motor_temperature_, motor_loss, ambient_temperature_);
    stage_thermal_.advance(stage_temperature_, stage_loss, ambient_temperature_);
  }
  // What is left of the time belongs to the mean that has just been used.
  square_current_ = mean_square * unheated_.seconds();
  winding.set_temperatures(motor_temperature_);
  sensing_.driver_temperature = stage_temperature_.inner + heat.driver_reading;
  sensing_.winding_temperature = motor_temperature_.inner;
}

template <typename Of>
[[gnu::always_inline]] inline void PwmAxis::sense(const Of& winding, double period) {
  const typename Of::Values current = winding.currents();
  const double second = Of::kBridges > 2 ? current[Of::kBridges > 2 ? 2 : 0] : 0.0;
  sensing_.converter =
      converter_.sample(converter_state_, {current[0], second}, supply_state_.voltage,
                        stage_temperature_.outer, period, converter_noise_);
  if (parameters_.halls.fitted) {
    hall_levels_ = halls_.next(hall_levels_, winding.direction());
  }
  sensing_.halls = halls_.signal(hall_levels_);
  if (faulty_) [[unlikely]] {
    sensing_.halls = through_cable(sensing_.halls, faults_.halls_swapped, faults_.halls);
  }
  if (analog_halls_.fitted()) {
    sensing_.analog_halls = analog_halls_.read(winding.angle(), angle_noise_);
  }
  if (analog_encoder_.fitted()) {
    sensing_.analog_encoder = analog_encoder_.read(winding.angle(), angle_noise_);
  }
  sense_encoders(winding, period);
}

template <typename Of>
[[gnu::always_inline]] inline void PwmAxis::sense_encoders(const Of& winding, double period) {
  const ElectricalAngle& angle = winding.angle();
  for (std::size_t k = 0; k < encoders_.size(); ++k) {
    if (parameters_.encoders[k].counts_per_revolution <= 0) {
      continue;
    }
    EncoderState& state = encoder_states_[k];
    encoders_[k].update(state, disturbances_[k].seen(angle));
    if (spoiled_) [[unlikely]] {
      spoil_encoder(k, angle, winding.torque());
    }
    EncoderReading& reading = sensing_.encoders[k];
    reading.count =
        disturbances_[k].update(disturbance_states_[k], encoders_[k].count(state), period);
    if (state.index_passages != reading.index_passages) {
      reading.index_passages = state.index_passages;
      reading.index_count = encoders_[k].index_count(state) - disturbance_states_[k].lost;
    }
    reading.index = encoders_[k].index(state);
    if (spoiled_) [[unlikely]] {
      reading.count += noise(fault_state_.encoders[k], faults_.common.encoders[k]);
      reading.index = faults_.common.encoders[k].index_lost
                          ? parameters_.encoders[k].index_active_low
                          : reading.index;
    }
  }
}

}  // namespace stator::plant
