#include "stator/devices/tmc8670/drive_objects.hpp"

#include <algorithm>

namespace stator::devices::tmc8670 {

namespace {

base::SimDuration milliseconds(std::int64_t n) {
  return base::SimDuration(n * 1'000'000);
}

/// Bits of 2053h.
constexpr unsigned kHome = 1;
constexpr unsigned kLeft = 2;
constexpr unsigned kRight = 4;

drive::SwitchInput switch_input(unsigned bit, unsigned active_high, unsigned not_used) {
  return {.used = (not_used & bit) == 0, .inverted = (active_high & bit) == 0};
}

std::uint32_t at_least_one(std::uint32_t value) {
  return std::max<std::uint32_t>(value, 1);
}

}  // namespace

DriveObjects::DriveObjects(const dictionary::Dictionary& dictionary) {
  const auto bind = [&]<typename T>(Variable<T>& variable, std::uint16_t index,
                                    std::uint8_t subindex = 0) {
    variable = dictionary.variable<T>(index, subindex);
  };
  bind(velocity_window_, 0x606D);
  bind(velocity_window_time_, 0x606E);
  bind(velocity_threshold_, 0x606F);
  bind(velocity_threshold_time_, 0x6070);
  bind(maximum_torque_, 0x6072);
  bind(maximum_current_, 0x6073);
  bind(rated_current_, 0x6075);
  bind(polarity_, 0x607E);
  bind(maximum_profile_velocity_, 0x607F);
  bind(maximum_speed_, 0x6080);
  bind(increments_, 0x608F, 1);
  bind(revolutions_, 0x608F, 2);
  bind(commutation_source_, 0x2020, 1);
  bind(torque_limit_, 0x2031, 1);
  bind(velocity_limit_, 0x2031, 3);
  bind(commutation_method_, 0x2050, 1);
  bind(commutation_current_, 0x2050, 2);
  bind(commutation_time_, 0x2050, 3);
  bind(commutation_voltage_, 0x2050, 4);
  bind(commutation_movement_, 0x2050, 5);
  bind(voltage_step_, 0x2051, 1);
  bind(voltage_offset_, 0x2051, 2);
  bind(undervoltage_, 0x2051, 3);
  bind(overvoltage_, 0x2051, 4);
  bind(voltage_hysteresis_, 0x2051, 5);
  bind(current_step_, 0x2052, 1);
  bind(maximum_acceleration_, 0x2052, 2);
  bind(standstill_, 0x2052, 3);
  bind(switches_active_high_, 0x2053, 1);
  bind(switches_not_used_, 0x2053, 2);
  bind(home_offset_is_position_, 0x2053, 3);
  bind(brake_hold_, 0x2054, 1);
  bind(brake_release_, 0x2054, 2);
  bind(brake_apply_, 0x2054, 3);
  bind(hard_stop_current_, 0x2055, 1);
  bind(positive_clearance_, 0x2055, 2);
  bind(negative_clearance_, 0x2055, 3);
}

void DriveObjects::configure(drive::FocAxis& axis) const {
  configure_axis(axis.settings());
  configure_profile(axis.foc_settings());
  configure_stage(axis.foc_settings());
}

void DriveObjects::configure_axis(drive::AxisSettings& settings) const {
  const unsigned high = switches_active_high_.get();
  const unsigned not_used = switches_not_used_.get();
  settings.behaviour = drive::kFocBehaviour;
  settings.reference.switches = {.left = switch_input(kLeft, high, not_used),
                                 .right = switch_input(kRight, high, not_used),
                                 .home = switch_input(kHome, high, not_used)};
  settings.reference.home_offset_is_position = home_offset_is_position_.get() != 0;
  settings.delays = {.hold_current = milliseconds(brake_hold_.get()),
                     .brake_release = milliseconds(brake_release_.get()),
                     .brake_apply = milliseconds(brake_apply_.get())};
  settings.hard_stop = {.current = 1e-3 * hard_stop_current_.get(),
                        .positive_clearance = positive_clearance_.get(),
                        .negative_clearance = negative_clearance_.get()};
}

void DriveObjects::configure_profile(drive::FocSettings& settings) const {
  settings.counts_per_revolution =
      at_least_one(increments_.get() / at_least_one(revolutions_.get()));
  settings.polarity = polarity_.get();
  settings.velocity_units = velocity_units_;
  settings.rated_current = at_least_one(rated_current_.get());
  settings.maximum_torque = maximum_torque_.get();
  settings.maximum_current = maximum_current_.get();
  settings.maximum_speed = maximum_speed_.get();
  settings.maximum_profile_velocity = maximum_profile_velocity_.get();
  settings.maximum_acceleration = maximum_acceleration_.get();
  settings.velocity_window = velocity_window_.get();
  settings.velocity_window_time = velocity_window_time_.get();
  settings.velocity_threshold = velocity_threshold_.get();
  settings.velocity_threshold_time = velocity_threshold_time_.get();
  settings.standstill = standstill_.get();
}

void DriveObjects::configure_stage(drive::FocSettings& settings) const {
  settings.current_per_step = 1e-6 * current_step_.get();
  settings.torque_flux_limit = torque_limit_.get();
  settings.velocity_limit = std::min<std::uint32_t>(velocity_limit_.get(), 2147483647);
  settings.volts_per_step = 1e-6 * voltage_step_.get();
  settings.voltage_offset = voltage_offset_.get();
  settings.undervoltage = 1e-3 * undervoltage_.get();
  settings.overvoltage = 1e-3 * overvoltage_.get();
  settings.voltage_hysteresis = 1e-3 * voltage_hysteresis_.get();
  settings.commutation = {
      .method = static_cast<drive::CommutationMethod>(commutation_method_.get()),
      .source = commutation_source_.get(),
      .current = 1e-3 * commutation_current_.get(),
      .hold_time = milliseconds(commutation_time_.get()),
      .minimal_movement_voltage = commutation_voltage_.get(),
      .largest_movement = commutation_movement_.get()};
}

}  // namespace stator::devices::tmc8670
