#include "stator/devices/tmcm_3315/driver_objects.hpp"

#include <array>

namespace stator::devices::tmcm_3315 {

namespace {

using drive::AxisError;

struct FlagBit {
  unsigned bit;
  AxisError error;
};

/// 2102h (document L1598-L1605).
constexpr std::array kFlagBits{
    FlagBit{7, AxisError::over_temperature}, FlagBit{6, AxisError::over_temperature_warning},
    FlagBit{5, AxisError::undervoltage},     FlagBit{4, AxisError::overcurrent_high_side},
    FlagBit{3, AxisError::open_load_b},      FlagBit{2, AxisError::open_load_a},
    FlagBit{1, AxisError::overcurrent_b},    FlagBit{0, AxisError::overcurrent_a},
};

}  // namespace

DriverObjects::DriverObjects(dictionary::Dictionary& dictionary, std::uint16_t index_offset) {
  const auto bind = [&]<typename T>(dictionary::Variable<T>& variable, unsigned index) {
    variable = dictionary.variable<T>(static_cast<std::uint16_t>(index + index_offset), 0);
  };
  bind(blank_time_, 0x2092);
  bind(chopper_mode_, 0x2093);
  bind(hysteresis_decrement_, 0x2094);
  bind(hysteresis_end_, 0x2095);
  bind(hysteresis_start_, 0x2096);
  bind(off_time_, 0x2097);
  bind(cool_step_minimum_, 0x2098);
  bind(cool_step_down_, 0x2099);
  bind(cool_step_hysteresis_, 0x209A);
  bind(cool_step_up_, 0x209B);
  bind(cool_step_hysteresis_start_, 0x209C);
  bind(stall_guard_filter_, 0x209D);
  bind(stall_guard_threshold_, 0x209E);
  bind(short_protection_disable_, 0x20A1);
  bind(stop_on_stall_, 0x20A4);
  bind(cool_step_threshold_, 0x20A5);
  bind(pwm_threshold_, 0x20B0);
  bind(pwm_gradient_, 0x20B1);
  bind(pwm_amplitude_, 0x20B2);
  bind(load_value_, 0x2101);
  bind(error_flags_, 0x2102);
}

void DriverObjects::configure(const drive::MotionUnits& units,
                              drive::DriverSettings& driver) const {
  driver.stall_guard = {.threshold = stall_guard_threshold_.get(),
                        .filter = stall_guard_filter_.get() != 0};
  driver.stall_velocity = units.velocity(stop_on_stall_.get());
  driver.cool_step = {.minimum = cool_step_minimum_.get(),
                      .down_step = cool_step_down_.get(),
                      .up_step = cool_step_up_.get(),
                      .hysteresis = cool_step_hysteresis_.get(),
                      .hysteresis_start = cool_step_hysteresis_start_.get()};
  driver.cool_step_velocity = units.velocity(cool_step_threshold_.get());
  driver.stealth_chop = {.threshold_velocity = units.velocity(pwm_threshold_.get()),
                         .gradient = pwm_gradient_.get(),
                         .amplitude = pwm_amplitude_.get()};
  driver.chopper = {.blank_time = blank_time_.get(),
                    .constant_off_time = chopper_mode_.get() != 0,
                    .hysteresis_decrement = hysteresis_decrement_.get(),
                    .hysteresis_end = hysteresis_end_.get(),
                    .hysteresis_start = hysteresis_start_.get(),
                    .off_time = off_time_.get()};
  driver.short_protection = short_protection_disable_.get() == 0;
}

void DriverObjects::publish(const drive::DriverChip& driver) {
  unsigned bits = 0;
  for (const FlagBit& flag : kFlagBits) {
    bits |= driver.flags().has(flag.error) ? 1U << flag.bit : 0U;
  }
  error_flags_.set(static_cast<std::uint8_t>(bits));
  load_value_.set(driver.stall_guard());
}

}  // namespace stator::devices::tmcm_3315
