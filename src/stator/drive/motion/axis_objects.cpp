#include "stator/drive/motion/axis_objects.hpp"

#include <algorithm>
#include <stdexcept>

namespace stator::drive {

IntegerObject::IntegerObject(dictionary::Dictionary& dictionary, std::uint16_t index)
    : entry_(dictionary.find(index, 0)) {
  if (entry_ == nullptr) {
    throw std::logic_error("an object of CiA 402 is missing in the dictionary");
  }
  constexpr unsigned kLongest = 32;
  const auto bits = static_cast<unsigned>(entry_->bits());
  if (bits > kLongest) {
    throw std::logic_error("an object of CiA 402 is longer than 32 bits");
  }
  const bool is_signed = dictionary::is_signed(entry_->type());
  minimum_ = is_signed ? -(std::int64_t{1} << (bits - 1)) : 0;
  maximum_ = (std::int64_t{1} << (is_signed ? bits - 1 : bits)) - 1;
}

IntegerObject IntegerObject::optional(dictionary::Dictionary& dictionary, std::uint16_t index) {
  return dictionary.find(index, 0) != nullptr ? IntegerObject(dictionary, index) : IntegerObject();
}

void IntegerObject::set(std::int64_t value) {
  if (exists()) {
    entry_->set_value(static_cast<std::uint64_t>(std::clamp(value, minimum_, maximum_)));
  }
}

AxisObjects::AxisObjects(dictionary::Dictionary& dictionary, std::uint16_t index_offset) {
  const auto at = [index_offset](unsigned index) {
    return static_cast<std::uint16_t>(index + index_offset);
  };
  const auto bind = [&]<typename T>(dictionary::Variable<T>& variable, unsigned index,
                                    std::uint8_t subindex = 0) {
    variable = dictionary.variable<T>(at(index), subindex);
  };
  const auto bind_optional = [&]<typename T>(OptionalVariable<T>& variable, unsigned index,
                                             std::uint8_t subindex = 0) {
    if (dictionary.find(at(index), subindex) != nullptr) {
      variable.bind(dictionary.variable<T>(at(index), subindex));
    }
  };
  const auto integer = [&](unsigned index) { return IntegerObject(dictionary, at(index)); };
  const auto optional_integer = [&](unsigned index) {
    return IntegerObject::optional(dictionary, at(index));
  };
  bind(controlword, 0x6040);
  bind(statusword, 0x6041);
  quick_stop_option = integer(0x605A);
  shutdown_option = integer(0x605B);
  disable_operation_option = integer(0x605C);
  halt_option = optional_integer(0x605D);
  fault_reaction_option = integer(0x605E);
  bind(mode, 0x6060);
  bind(mode_display, 0x6061);
  bind(position_demand, 0x6062);
  bind(position_internal, 0x6063);
  bind(position_actual, 0x6064);
  bind_optional(following_window, 0x6065);
  bind_optional(following_time_out, 0x6066);
  bind(position_window, 0x6067);
  bind_optional(position_window_time, 0x6068);
  bind_optional(sensor_selection, 0x606A);
  bind_optional(velocity_demand, 0x606B);
  bind(velocity_actual, 0x606C);
  target_torque = optional_integer(0x6071);
  torque_actual = optional_integer(0x6077);
  bind(target_position, 0x607A);
  bind(home_offset, 0x607C);
  bind(minimum_position, 0x607D, 1);
  bind(maximum_position, 0x607D, 2);
  bind(profile_velocity, 0x6081);
  end_velocity = optional_integer(0x6082);
  bind(profile_acceleration, 0x6083);
  bind(profile_deceleration, 0x6084);
  bind(quick_stop_deceleration, 0x6085);
  profile_type = optional_integer(0x6086);
  bind_optional(torque_slope, 0x6087);
  bind(encoder_increments, 0x608F, 1);
  bind(homing_method, 0x6098);
  bind(homing_fast_speed, 0x6099, 1);
  bind(homing_slow_speed, 0x6099, 2);
  bind(homing_acceleration, 0x609A);
  for (std::size_t i = 0; i < jerk.size(); ++i) {
    bind_optional(jerk[i], 0x60A4, static_cast<std::uint8_t>(i + 1));
  }
  bind_optional(position_offset, 0x60B0);
  bind_optional(velocity_offset, 0x60B1);
  torque_offset = optional_integer(0x60B2);
  bind_optional(interpolation_value, 0x60C2, 1);
  bind_optional(interpolation_index, 0x60C2, 2);
  bind_optional(positioning_option, 0x60F2);
  bind_optional(following_error, 0x60F4);
  bind(target_velocity, 0x60FF);
  bind_optional(supported_modes, 0x6502);
}

base::SimDuration AxisObjects::interpolation_period() const {
  constexpr int kSecond = 9;  // a second is 10^9 ns
  if (!interpolation_index.exists()) {
    return base::SimDuration(0);
  }
  std::int64_t nanoseconds = interpolation_value.get() == 0 ? 1 : interpolation_value.get();
  for (int exponent = interpolation_index.get() + kSecond; exponent > 0; --exponent) {
    nanoseconds *= 10;
  }
  return base::SimDuration(nanoseconds);
}

}  // namespace stator::drive
