#include "drive/axis_objects.hpp"

#include <stdexcept>

namespace stator::drive {

OptionCode::OptionCode(const dictionary::Dictionary& dictionary, std::uint16_t index)
    : entry_(dictionary.find(index, 0)) {
  if (entry_ == nullptr) {
    throw std::logic_error("an option code of CiA 402 is missing in the dictionary");
  }
}

AxisObjects::AxisObjects(const dictionary::Dictionary& dictionary, std::uint16_t index_offset) {
  const auto at = [index_offset](unsigned index) {
    return static_cast<std::uint16_t>(index + index_offset);
  };
  const auto bind = [&]<typename T>(dictionary::Variable<T>& variable, unsigned index,
                                    std::uint8_t subindex = 0) {
    variable = dictionary.variable<T>(at(index), subindex);
  };
  bind(controlword, 0x6040);
  bind(statusword, 0x6041);
  quick_stop_option = OptionCode(dictionary, at(0x605A));
  shutdown_option = OptionCode(dictionary, at(0x605B));
  disable_operation_option = OptionCode(dictionary, at(0x605C));
  fault_reaction_option = OptionCode(dictionary, at(0x605E));
  bind(mode, 0x6060);
  bind(mode_display, 0x6061);
  bind(position_demand, 0x6062);
  bind(position_internal, 0x6063);
  bind(position_actual, 0x6064);
  bind(following_window, 0x6065);
  bind(position_window, 0x6067);
  bind(position_window_time, 0x6068);
  bind(sensor_selection, 0x606A);
  bind(velocity_actual, 0x606C);
  bind(target_torque, 0x6071);
  bind(torque_actual, 0x6077);
  bind(target_position, 0x607A);
  bind(home_offset, 0x607C);
  bind(minimum_position, 0x607D, 1);
  bind(maximum_position, 0x607D, 2);
  bind(profile_velocity, 0x6081);
  bind(end_velocity, 0x6082);
  bind(profile_acceleration, 0x6083);
  bind(profile_deceleration, 0x6084);
  bind(quick_stop_deceleration, 0x6085);
  bind(profile_type, 0x6086);
  bind(encoder_increments, 0x608F, 1);
  bind(homing_method, 0x6098);
  bind(homing_fast_speed, 0x6099, 1);
  bind(homing_slow_speed, 0x6099, 2);
  bind(homing_acceleration, 0x609A);
  for (std::size_t i = 0; i < jerk.size(); ++i) {
    bind(jerk[i], 0x60A4, static_cast<std::uint8_t>(i + 1));
  }
  bind(position_offset, 0x60B0);
  bind(velocity_offset, 0x60B1);
  bind(torque_offset, 0x60B2);
  bind(interpolation_value, 0x60C2, 1);
  bind(interpolation_index, 0x60C2, 2);
  bind(positioning_option, 0x60F2);
  bind(target_velocity, 0x60FF);
}

base::SimDuration AxisObjects::interpolation_period() const {
  constexpr int kSecond = 9;  // a second is 10^9 ns
  std::int64_t nanoseconds = interpolation_value.get() == 0 ? 1 : interpolation_value.get();
  for (int exponent = interpolation_index.get() + kSecond; exponent > 0; --exponent) {
    nanoseconds *= 10;
  }
  return base::SimDuration(nanoseconds);
}

}  // namespace stator::drive
