#include "stator/drive/stepper/driver_chip.hpp"

#include <cmath>
#include <cstddef>

namespace stator::drive {

namespace {

/// s. In a shorter half wave the current may not rise far enough to show that a load is connected.
constexpr double kShortestHalfWave = 200e-6;

/// While the chip shows one of these the stage is off.
constexpr AxisErrors kStageOff{AxisError::overcurrent_a, AxisError::overcurrent_b,
                               AxisError::overcurrent_high_side, AxisError::over_temperature,
                               AxisError::undervoltage};

}  // namespace

void DriverChip::advance(const StepperSettings& settings, double velocity,
                         base::AxisActuation& actuation, const base::AxisSensing& sensing) {
  supply_voltage_ = sensing.supply_voltage;
  temperature_ = sensing.driver_temperature;
  const DriverSettings& driver = settings.driver;
  if (actuation.bridge_enabled && driver.short_protection) {
    detect_shorts(sensing);
  }
  actuation.bridge_enabled = actuation.bridge_enabled && !flags_.any_of(kStageOff);
  if (!actuation.bridge_enabled) {
    if (conducts_) {
      switch_off();
    }
    return;
  }
  conducts_ = true;
  current_target_ = actuation.coil_current_target;
  voltage_mode_ = false;
  const double speed = std::fabs(velocity);
  if (driver.stealth_chop.active_at(speed)) {
    voltage_mode_ = true;
    if (measures_) {
      stop_measuring();
    }
    const double amplitude = std::sqrt(current_target_[0] * current_target_[0] +
                                       current_target_[1] * current_target_[1]);
    const auto microsteps = static_cast<double>(1U << (8U - settings.microstep_resolution));
    actuation.voltage_mode = true;
    actuation.coil_duty = control::coil_duty(
        current_target_, control::stealth_chop_duty(driver.stealth_chop, speed * microsteps,
                                                    amplitude / settings.full_scale_current));
  }
  if (speed > 0.0) {
    measure(settings, velocity, speed, actuation, sensing);
  } else if (measures_) {
    stop_measuring();
  }
}

void DriverChip::measure(const StepperSettings& settings, double velocity, double speed,
                         const base::AxisActuation& actuation, const base::AxisSensing& sensing) {
  const DriverSettings& driver = settings.driver;
  const auto half_wave = static_cast<double>(2U << settings.microstep_resolution);
  if (half_wave >= kShortestHalfWave * speed) [[likely]] {
    open_load_.advance(actuation.coil_current_target, sensing.coil_current);
  } else {
    open_load_.skip();
  }
  if (voltage_mode_) {
    return;
  }
  measures_ = true;
  const bool cool = driver.cool_step.hysteresis_start > 0 && speed > driver.cool_step_velocity;
  if (!cool) {
    cool_step_.reset();
  }
  if (!stall_guard_.advance(driver.stall_guard, actuation.coil_current_target, velocity > 0.0,
                            sensing)) {
    return;
  }
  if (cool) {
    cool_step_.measured(driver.cool_step, settings.currents.run, stall_guard_.value());
  }
  stalled_ = stalled_ || (driver.stall_velocity > 0.0 && speed > driver.stall_velocity &&
                          stall_guard_.value() == 0);
}

void DriverChip::switch_off() {
  conducts_ = false;
  voltage_mode_ = false;
  open_load_.reset();
  stop_measuring();
}

void DriverChip::stop_measuring() {
  measures_ = false;
  stall_guard_.reset();
  cool_step_.reset();
}

void DriverChip::detect_shorts(const base::AxisSensing& sensing) {
  if (sensing.overcurrent[0] || sensing.overcurrent[1] || sensing.overcurrent_high_side)
      [[unlikely]] {
    const auto set = [this](AxisError error, bool seen) {
      flags_.set(error, seen || flags_.has(error));
    };
    set(AxisError::overcurrent_a, sensing.overcurrent[0]);
    set(AxisError::overcurrent_b, sensing.overcurrent[1]);
    set(AxisError::overcurrent_high_side, sensing.overcurrent_high_side);
  }
}

void DriverChip::clear_shorts() {
  for (const AxisError error :
       {AxisError::overcurrent_a, AxisError::overcurrent_b, AxisError::overcurrent_high_side}) {
    flags_.set(error, false);
  }
}

void DriverChip::supervise(const DriverLimits& limits) {
  flags_.set(AxisError::open_load_a, open_load_.open(0));
  flags_.set(AxisError::open_load_b, open_load_.open(1));
  const auto hot = [&](AxisError error, double limit) {
    const double release = limit - limits.temperature_hysteresis;
    flags_.set(error, temperature_ >= (flags_.has(error) ? release : limit));
  };
  hot(AxisError::over_temperature_warning, limits.warning_temperature);
  hot(AxisError::over_temperature, limits.shutdown_temperature);
  const bool low = flags_.has(AxisError::undervoltage);
  flags_.set(AxisError::undervoltage,
             supply_voltage_ < limits.undervoltage + (low ? limits.undervoltage_hysteresis : 0.0));
}

}  // namespace stator::drive
