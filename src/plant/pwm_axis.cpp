#include "plant/pwm_axis.hpp"

#include <algorithm>
#include <optional>
#include <type_traits>

#include "plant/switched_inverter.hpp"
#include "plant/switched_turn.hpp"

namespace stator::plant {

namespace {

/// Rounding errors of the small rotations are removed so often.
constexpr base::SimDuration kRefreshPeriod{10'000'000};

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
      converter_(p.converter),
      halls_(p.halls),
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
  constexpr double kAnyPeriod = 1.0;
  std::visit(
      [&](const auto& winding) {
        for (std::size_t k = 0; k < encoders_.size(); ++k) {
          disturbance_states_[k].random = base::Random(p.noise_seed + 2 + k);
          encoder_states_[k] = encoders_[k].power_on(disturbances_[k].seen(winding.angle()));
        }
        hall_levels_ = halls_.power_on(winding.direction());
        sense(winding, kAnyPeriod);
      },
      winding_);
}

template <typename Of>
double PwmAxis::pass(Of& winding, const PwmActuation& actuation, double period) {
  if (!actuation.bridge_enabled) {
    const double energy = winding.coast(supply_state_.voltage, shaft_, period);
    supply_.draw(supply_state_, energy / period, period, actuation.brake_chopper_on);
    return energy;
  }
  typename Of::Values duty{};
  for (std::size_t k = 0; k < Of::kBridges; ++k) {
    duty[k] = std::clamp(actuation.duty[k], 0.0, 1.0);
  }
  if (parameters_.inverter_model == InverterModel::switched) {
    if constexpr (std::is_same_v<Of, ThreePhaseWinding>) {
      const std::optional<double> energy =
          turn_switched(winding, parameters_.inverter, supply_, supply_state_, duty, shaft_,
                        actuation.brake_chopper_on, period);
      if (energy) [[likely]] {
        return *energy;
      }
    }
    return switch_period(winding, parameters_.inverter, supply_, supply_state_, duty, shaft_,
                         actuation.brake_chopper_on, period);
  }
  return average_period(winding, parameters_.inverter.dead_time > 0.0 ? &dead_time_ : nullptr,
                        supply_, supply_state_, duty, shaft_, actuation.brake_chopper_on, period);
}

void PwmAxis::set_period(base::SimDuration period) {
  const double inductance =
      std::visit([](const auto& winding) { return winding.inductance(); }, winding_);
  dead_time_ = DeadTime(parameters_.inverter, inductance, period.seconds());
  dead_time_period_ = period;
}

const PwmSensing& PwmAxis::step(const PwmActuation& actuation, base::SimDuration period) {
  parameters_.brake.advance(brake_, actuation.brake_released, period);
  shaft_.brake_engaged = !brake_.open;
  unrefreshed_ += period;
  if (period != dead_time_period_) [[unlikely]] {
    set_period(period);
  }
  const bool refresh = unrefreshed_ >= kRefreshPeriod;
  std::visit(
      [&](auto& winding) {
        bridge_energy_ += pass(winding, actuation, period.seconds());
        if (refresh) {
          winding.refresh();
        }
        sense(winding, period.seconds());
      },
      winding_);
  if (refresh) {
    unrefreshed_ = {};
  }
  return sensing_;
}

template <typename Of>
void PwmAxis::sense(const Of& winding, double period) {
  const typename Of::Values current = winding.currents();
  const double second = Of::kBridges > 2 ? current[Of::kBridges > 2 ? 2 : 0] : 0.0;
  sensing_.converter =
      converter_.sample(converter_state_, {current[0], second}, supply_state_.voltage,
                        parameters_.temperature, period, converter_noise_);
  if (parameters_.halls.fitted) {
    hall_levels_ = halls_.next(hall_levels_, winding.direction());
  }
  sensing_.halls = halls_.signal(hall_levels_);
  if (analog_halls_.fitted()) {
    sensing_.analog_halls = analog_halls_.read(winding.angle(), angle_noise_);
  }
  if (analog_encoder_.fitted()) {
    sensing_.analog_encoder = analog_encoder_.read(winding.angle(), angle_noise_);
  }
  sense_encoders(winding.angle(), period);
}

void PwmAxis::sense_encoders(const ElectricalAngle& angle, double period) {
  for (std::size_t k = 0; k < encoders_.size(); ++k) {
    if (parameters_.encoders[k].counts_per_revolution <= 0) {
      continue;
    }
    EncoderState& state = encoder_states_[k];
    encoders_[k].update(state, disturbances_[k].seen(angle));
    EncoderReading& reading = sensing_.encoders[k];
    reading.count =
        disturbances_[k].update(disturbance_states_[k], encoders_[k].count(state), period);
    if (state.index_passages != reading.index_passages) {
      reading.index_passages = state.index_passages;
      reading.index_count = encoders_[k].index_count(state) - disturbance_states_[k].lost;
    }
    reading.index = encoders_[k].index(state);
  }
}

void PwmAxis::set_supply_voltage(double voltage) {
  supply_state_.source = voltage;
  if (supply_.ideal()) {
    supply_state_.voltage = voltage;
  }
}

std::array<double, 4> PwmAxis::currents() const {
  std::array<double, 4> result{};
  std::visit(
      [&result](const auto& winding) {
        const auto current = winding.currents();
        std::copy(current.begin(), current.end(), result.begin());
      },
      winding_);
  return result;
}

double PwmAxis::speed() const {
  return std::visit([](const auto& winding) { return winding.speed(); }, winding_);
}

double PwmAxis::revolutions() const {
  return std::visit(
      [](const auto& winding) {
        return electrical_radians(winding.angle()) / (base::kTwoPi * winding.pole_pairs());
      },
      winding_);
}

double PwmAxis::electromagnetic_torque() const {
  return std::visit([](const auto& winding) { return winding.torque(); }, winding_);
}

}  // namespace stator::plant
