#include "stator/devices/tmcm_3315/axis_unit.hpp"

#include <cmath>

#include "stator/base/input_appender.hpp"
#include "stator/devices/tmcm_3315/emergencies.hpp"
#include "stator/devices/tmcm_3315/objects.hpp"

namespace stator::devices::tmcm_3315 {

namespace {

using base::EventArgument;
using base::EventRule;
using base::Severity;
using dictionary::Entry;

constexpr std::uint8_t kInternalUnits = 0;            // of 208Ch and 208Eh
constexpr std::uint8_t kPulsesPerSquareSecond = 179;  // of 208Eh

constexpr EventRule kReservedOption{
    "tmcm3315-positioning-option", Severity::refusal,
    "write to {0:x4} refused: bits 1..0 of {1:x4} are 11b, which is reserved; use 00b, 01b or 10b"};

base::SimDuration milliseconds(std::int64_t n) {
  return base::SimDuration(n * 1'000'000);
}

constexpr std::uint16_t manufacturer_offset(std::uint8_t axis) {
  return static_cast<std::uint16_t>(axis * kManufacturerAxisOffset);
}
constexpr std::uint16_t profile_offset(std::uint8_t axis) {
  return static_cast<std::uint16_t>(axis * kProfileAxisOffset);
}

}  // namespace

AxisManufacturerObjects::AxisManufacturerObjects(dictionary::Dictionary& dictionary,
                                                 std::uint16_t index_offset,
                                                 std::uint16_t profile_index_offset) {
  const auto bind = [&]<typename T>(dictionary::Variable<T>& variable, unsigned index,
                                    std::uint8_t subindex = 0) {
    variable = dictionary.variable<T>(static_cast<std::uint16_t>(index + index_offset), subindex);
  };
  bind(microstep_resolution, 0x2000);
  bind(full_steps, 0x2001);
  bind(brake_apply_delay, 0x2002, 1);
  bind(brake_release_delay, 0x2002, 2);
  bind(run_current, 0x2003);
  bind(standby_current, 0x2004);
  bind(enable_delay, 0x200A);
  bind(encoder_reversed, 0x200B, 2);
  bind(position_from_encoder, 0x200B, 3);
  bind(brake_apply_current, 0x200C, 1);
  bind(brake_release_current, 0x200C, 2);
  bind(boost_current, 0x204E);
  bind(standby_delay, 0x2089);
  bind(velocity_dimension, 0x208C);
  bind(acceleration_dimension, 0x208E);
  bind(chopper_off_time, 0x2097);
  bind(home_offset_display, 0x2100);
  bind(microstep_resolution_display, 0x2107);
  bind(step_counter_low, 0x210B, 1);
  bind(step_counter_high, 0x210B, 2);
  bind(step_counter, 0x210B, 3);
  digital_inputs = dictionary.variable<std::uint32_t>(
      static_cast<std::uint16_t>(0x60FD + profile_index_offset), 0);
}

AxisUnit::AxisUnit(dictionary::Dictionary& dictionary, std::uint8_t number,
                   const plant::StepperAxisParameters& plant,
                   const AxisUnitConfiguration& configuration, base::EventReporter reporter)
    : dictionary_(dictionary),
      number_(number),
      configuration_(configuration),
      reporter_(reporter),
      objects_(dictionary, manufacturer_offset(number), profile_offset(number)),
      reference_(dictionary, manufacturer_offset(number)),
      closed_loop_objects_(dictionary, manufacturer_offset(number)),
      driver_objects_(dictionary, manufacturer_offset(number)),
      ramp_objects_(dictionary, manufacturer_offset(number)),
      plant_(plant),
      fault_inputs_(plant_, {plant::AxisPart::limit_switches, plant::AxisPart::home_switch,
                             plant::AxisPart::brake, plant::AxisPart::encoder,
                             plant::AxisPart::driver_thermometer}),
      sensing_(plant_.sensing()) {
  const auto own = [number](unsigned index) {
    return static_cast<std::uint16_t>(index + manufacturer_offset(number));
  };
  const auto profile = [number](unsigned index) {
    return static_cast<std::uint16_t>(index + profile_offset(number));
  };
  using Written = Entry::WrittenHook;
  const auto mirror = Written::bind<&AxisUnit::mirror_objects>(*this);
  dictionary.on_written(own(0x2000), 0, mirror);
  dictionary.on_written(own(0x208C), 0, mirror);
  dictionary.on_written(profile(0x607C), 0, mirror);
  const auto place = Written::bind<&AxisUnit::place_position>(*this);
  dictionary.on_written(profile(0x606A), 0, place);
  dictionary.on_written(profile(0x608F), 1, place);
  dictionary.on_written(own(0x200B), 2, place);
  dictionary.on_written(own(0x200B), 3, place);
  dictionary.on_check(profile(0x60F2), 0,
                      Entry::CheckHook::bind<&AxisUnit::check_positioning_option>(*this));
  const auto latch = Entry::ReadHook::bind<&AxisUnit::latch_step_counter>(*this);
  dictionary.on_read(own(0x210B), 1, latch);
  dictionary.on_read(own(0x210B), 3, latch);
  restart(base::SimTime());
}

void AxisUnit::restart(base::SimTime now) {
  axis_.emplace(dictionary_,
                drive::AxisConfiguration{.number = number_,
                                         .profile_offset = profile_offset(number_),
                                         .reactions = drive::reactions_of(kEmergencies)},
                reporter_);
  tick(now, 0);
}

std::int64_t AxisUnit::microsteps_per_revolution() const {
  return std::int64_t{objects_.full_steps.get()} << objects_.microstep_resolution.get();
}

void AxisUnit::configure() {
  drive::AxisSettings& settings = axis_->settings();
  drive::StepperSettings& stepper = axis_->stepper_settings();
  settings.units = objects_.velocity_dimension.get() == kInternalUnits
                       ? drive::MotionUnits::internal()
                       : drive::MotionUnits();
  stepper.microsteps_per_revolution = microsteps_per_revolution();
  stepper.microstep_resolution = objects_.microstep_resolution.get();
  settings.delays = {.hold_current = milliseconds(objects_.enable_delay.get()),
                     .brake_release = milliseconds(objects_.brake_release_delay.get()),
                     .brake_apply = milliseconds(objects_.brake_apply_delay.get())};
  ramp_objects_.configure(settings);
  stepper.encoder_reversed = objects_.encoder_reversed.get() != 0;
  settings.position_from_encoder = objects_.position_from_encoder.get() != 0;
  stepper.currents = {
      .run = objects_.run_current.get(),
      .standby = objects_.standby_current.get(),
      .boost = objects_.boost_current.get(),
      .standby_delay = milliseconds(std::int64_t{10} * objects_.standby_delay.get())};
  closed_loop_objects_.configure(settings.units, stepper);
  stepper.full_scale_current = configuration_.full_scale_current;
  stepper.chopper_enabled = objects_.chopper_off_time.get() != 0;
  driver_objects_.configure(settings.units, stepper.driver);
  stepper.driver.limits = configuration_.driver_limits;

  reference_.configure(settings.reference);
  settings.reference.home_offset_is_position = configuration_.home_offset_is_position;
  axis_->conditions().set_switches(
      settings.reference.switches.pressed(drive::switch_levels(sensing_)));
}

bool AxisUnit::apply(base::SimTime now) {
  if (!axis_->has_commands()) {
    return false;
  }
  configure();
  axis_->apply(now);
  return true;
}

std::optional<std::uint8_t> AxisUnit::brake_feed() const {
  const std::uint8_t apply = objects_.brake_apply_current.get();
  const std::uint8_t release = objects_.brake_release_current.get();
  if (apply == 0 && release == 0) {
    return std::nullopt;
  }
  return axis_->brake_released() ? release : apply;
}

void AxisUnit::tick(base::SimTime now, std::uint32_t general_inputs) {
  configure();
  axis_->tick(now);
  closed_loop_objects_.exchange(*axis_);
  reference_.serve_latch(*axis_);
  objects_.digital_inputs.set(general_inputs | ReferenceObjects::digital_inputs(
                                                   axis_->settings().reference.switches, sensing_));
  driver_objects_.publish(axis_->driver());
}

void AxisUnit::set_network_operational(bool operational, base::SimTime now) {
  configure();
  if (operational) {
    axis_->conditions().network_operational = true;
  } else if (axis_->conditions().network_operational) {
    axis_->network_left_operational(now);
  }
}

void AxisUnit::mirror_objects(const Entry& /*entry*/) {
  objects_.microstep_resolution_display.set(objects_.microstep_resolution.get());
  objects_.acceleration_dimension.set(objects_.velocity_dimension.get() == kInternalUnits
                                          ? kInternalUnits
                                          : kPulsesPerSquareSecond);
  objects_.home_offset_display.set(axis_->objects().home_offset.get());
}

void AxisUnit::place_position(const Entry& /*entry*/) {
  if (axis_->power_state() != drive::PowerState::operation_enabled) {
    configure();
    axis_->initialise_position();
  }
}

void AxisUnit::latch_step_counter(Entry& /*entry*/) {
  const std::uint64_t steps = axis_->step_count();
  objects_.step_counter.set(steps);
  objects_.step_counter_low.set(static_cast<std::uint32_t>(steps));
  objects_.step_counter_high.set(static_cast<std::uint32_t>(steps >> 32U));
}

dictionary::Verdict AxisUnit::check_positioning_option(const Entry& entry, std::uint64_t bits) {
  if ((bits & 3U) == 3U) {
    return dictionary::refuse(
        dictionary::AbortCode::value_range_exceeded, kReservedOption,
        {EventArgument(int{entry.index()}), EventArgument(static_cast<std::int64_t>(bits))});
  }
  return {};
}

double AxisUnit::position_demand() const {
  const control::MicrostepPosition& position = axis_->motion().ramp().position();
  return static_cast<double>(position.microsteps) + position.fraction;
}

double AxisUnit::position_actual() const {
  return static_cast<double>(axis_->actual_position());
}

double AxisUnit::following_error() const {
  const double turned =
      plant_.observe().shaft_revolutions - plant_.parameters().initial_revolutions;
  return static_cast<double>(axis_->motion().ramp().motor_microsteps()) -
         turned * static_cast<double>(microsteps_per_revolution());
}

double AxisUnit::brake_open() const {
  return plant_.state().brake.open ? 1.0 : 0.0;
}

double AxisUnit::shaft_speed() const {
  return plant_.observe().speed / base::kTwoPi;
}

double AxisUnit::load_angle() const {
  return plant_.observe().load_angle * 180.0 / base::kPi;
}

double AxisUnit::current_scale() const {
  const std::array<double, 2>& target = axis_->driver().current_target();
  return axis_->driver().conducts() ? std::sqrt(target[0] * target[0] + target[1] * target[1]) /
                                          configuration_.full_scale_current
                                    : 0.0;
}

control::ChopperCycle AxisUnit::chopper_cycle() const {
  const drive::DriverChip& driver = axis_->driver();
  if (!driver.conducts()) {
    return {};
  }
  if (driver.voltage_mode()) {
    return {.frequency = control::kStealthChopFrequency, .ripple = 0.0};
  }
  const double current = current_scale() * configuration_.full_scale_current;
  const double induced = current > 0.0 ? sensing_.converted_power / current : 0.0;
  return control::chopper_cycle(axis_->stepper_settings().driver.chopper,
                                {.supply = sensing_.supply_voltage,
                                 .resistance = plant_.resistance(),
                                 .inductance = plant_.parameters().motor.inductance,
                                 .induced = induced,
                                 .current = current,
                                 .converter_step = configuration_.full_scale_current /
                                                   control::MicrostepSequencer::kAmplitude});
}

double AxisUnit::encoder_count() const {
  return static_cast<double>(sensing_.encoder_count);
}

void AxisUnit::append_signals(std::vector<product::Signal>& signals) const {
  const std::string prefix = "axis" + std::to_string(number_) + ".";
  const auto add = [&](const char* name, const char* unit, base::SignalReader read) {
    signals.push_back({prefix + name, unit, read});
  };
  using Read = base::SignalReader;
  add("position_demand", "microstep", Read::bind<&AxisUnit::position_demand>(*this));
  add("position_actual", "microstep", Read::bind<&AxisUnit::position_actual>(*this));
  add("velocity_demand", "pps", Read::bind<&AxisUnit::velocity_demand>(*this));
  add("velocity_actual", "pps", Read::bind<&AxisUnit::velocity_actual>(*this));
  add("following_error", "microstep", Read::bind<&AxisUnit::following_error>(*this));
  add("shaft_position", "rev", Read::bind<&AxisUnit::shaft_position>(*this));
  add("shaft_speed", "rev/s", Read::bind<&AxisUnit::shaft_speed>(*this));
  add("coil_current_a", "A", Read::bind<&AxisUnit::coil_current_a>(*this));
  add("coil_current_b", "A", Read::bind<&AxisUnit::coil_current_b>(*this));
  add("torque", "Nm", Read::bind<&AxisUnit::torque>(*this));
  add("load_torque", "Nm", Read::bind<&AxisUnit::load_torque>(*this));
  add("load_angle", "deg", Read::bind<&AxisUnit::load_angle>(*this));
  add("closed_loop", "", Read::bind<&AxisUnit::closed_loop>(*this));
  add("encoder", "count", Read::bind<&AxisUnit::encoder_count>(*this));
  add("brake_open", "", Read::bind<&AxisUnit::brake_open>(*this));
  add("supply_voltage", "V", Read::bind<&AxisUnit::supply_voltage>(*this));
  add("stall_guard", "count", Read::bind<&AxisUnit::stall_guard>(*this));
  add("current_scale", "", Read::bind<&AxisUnit::current_scale>(*this));
  add("driver_flags", "", Read::bind<&AxisUnit::driver_flags>(*this));
  add("chopper_frequency", "Hz", Read::bind<&AxisUnit::chopper_frequency>(*this));
  add("current_ripple", "A", Read::bind<&AxisUnit::current_ripple>(*this));
  add("winding_temperature", "degC", Read::bind<&AxisUnit::winding_temperature>(*this));
  add("driver_temperature", "degC", Read::bind<&AxisUnit::driver_temperature>(*this));
  add("controlword", "", Read::bind<&AxisUnit::controlword>(*this));
  add("statusword", "", Read::bind<&AxisUnit::statusword>(*this));
  add("mode", "", Read::bind<&AxisUnit::mode>(*this));
}

void AxisUnit::append_inputs(std::vector<product::Input>& inputs) {
  const plant::StepperAxisParameters& world = plant_.parameters();
  const std::string prefix = "axis" + std::to_string(number_) + ".";
  const base::InputAppender add(inputs, prefix);
  using Set = base::Delegate<void(double)>;
  add("load_torque", "Nm", -1000.0, 1000.0, Set::bind<&AxisUnit::set_load_torque>(*this),
      product::InputGroup::load);
  add("supply_voltage", "V", 0.0, 100.0, Set::bind<&AxisUnit::set_supply_voltage>(*this),
      product::InputGroup::supply, world.supply_voltage);
  add("left_switch", "", 0.0, 1.0, Set::bind<&AxisUnit::press_left_switch>(*this),
      product::InputGroup::switches);
  add("right_switch", "", 0.0, 1.0, Set::bind<&AxisUnit::press_right_switch>(*this),
      product::InputGroup::switches);
  add("home_switch", "", 0.0, 1.0, Set::bind<&AxisUnit::press_home_switch>(*this),
      product::InputGroup::switches);
  add("ambient_temperature", "degC", -50.0, 200.0,
      Set::bind<&AxisUnit::set_ambient_temperature>(*this), product::InputGroup::heat,
      world.ambient_temperature);
  using Faults = plant::StepperAxisFaults;
  add("open_load_a", "", 0.0, 1.0, Set::bind<&AxisUnit::set_phase_fault<&Faults::open, 0>>(*this),
      product::InputGroup::driver);
  add("open_load_b", "", 0.0, 1.0, Set::bind<&AxisUnit::set_phase_fault<&Faults::open, 1>>(*this),
      product::InputGroup::driver);
  add("short_a", "", 0.0, 1.0, Set::bind<&AxisUnit::set_phase_fault<&Faults::shorted, 0>>(*this),
      product::InputGroup::driver);
  add("short_b", "", 0.0, 1.0, Set::bind<&AxisUnit::set_phase_fault<&Faults::shorted, 1>>(*this),
      product::InputGroup::driver);
  add("short_high_side", "", 0.0, 1.0, Set::bind<&AxisUnit::set_fault<&Faults::high_side>>(*this),
      product::InputGroup::driver);
  add("encoder_counts_lost", "count", -1e6, 1e6, Set::bind<&AxisUnit::lose_counts>(*this),
      product::InputGroup::sensors);
  fault_inputs_.append(inputs, prefix);
}

}  // namespace stator::devices::tmcm_3315
