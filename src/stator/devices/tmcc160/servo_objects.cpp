#include "stator/devices/tmcc160/servo_objects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace stator::devices::tmcc160 {

namespace {

using base::EventRule;
using base::Severity;
using dictionary::AbortCode;
using drive::ModeCode;
using drive::PowerState;

// Arguments: {0} index, {1} subindex, {2} the value that came.
constexpr EventRule kOddPoles{"tmcc160-odd-poles", Severity::refusal,
                              "write to {0:x4}:{1:x2} refused: {2} poles came, but poles come in "
                              "pairs; write an even number"};
constexpr EventRule kNoEncoderSteps{
    "tmcc160-no-encoder-steps", Severity::refusal,
    "write to {0:x4}:{1:x2} refused: an encoder with {2} steps per revolution tells nothing; write "
    "its counts after quadrature, e.g. 4000"};
constexpr EventRule kCommutationInUse{
    "tmcc160-commutation-in-use", Severity::refusal,
    "write to {0:x4}:{1:x2} refused: the drive is in Operation enabled and works with its "
    "commutation mode; disable it first"};
constexpr EventRule kPositionInUse{
    "tmcc160-position-in-use", Severity::refusal,
    "write to {0:x4}:{1:x2} refused: the position cannot become {2} while the motor is positioned, "
    "homed or turns; stop it, and leave modes 1 and 6 or disable the drive"};
constexpr EventRule kSwitchesInUse{
    "tmcc160-switches-in-use", Severity::refusal,
    "write to {0:x4}:{1:x2} refused: limit switches may be configured in Switch on disabled only; "
    "write controlword 0 first"};

// Bits of 2005h.
constexpr unsigned kLeftOff = 1U << 0;
constexpr unsigned kRightOff = 1U << 1;
constexpr unsigned kLeftInverted = 1U << 2;
constexpr unsigned kRightInverted = 1U << 3;

/// Parameters that configure() hands on, first to last index.
struct IndexRange {
  std::uint16_t first;
  std::uint16_t last;
};
constexpr std::array kParameters{IndexRange{0x2005, 0x2005}, IndexRange{0x2010, 0x2095},
                                 IndexRange{0x608F, 0x608F}};

bool is_parameter(std::uint16_t index) {
  return std::ranges::any_of(kParameters, [index](const IndexRange& range) {
    return index >= range.first && index <= range.last;
  });
}

std::int64_t rounded(double value) {
  return std::llround(value);
}

/// What a value object shows.
struct ValueObject {
  std::uint16_t index;
  std::uint8_t subindex;
  std::int64_t (*read)(const drive::ServoAxis& axis);
};

std::int64_t target_velocity(const drive::ServoAxis& axis) {
  const auto limit = std::int64_t{axis.servo_settings().controller.maximum_velocity};
  const bool commanded = axis.mode() == ModeCode::profile_velocity &&
                         axis.power_state() == PowerState::operation_enabled;
  return commanded ? std::clamp(std::int64_t{axis.objects().target_velocity.get()}, -limit, limit)
                   : rounded(axis.controller().velocity_demand());
}

std::int64_t ramp_velocity(const drive::ServoAxis& axis) {
  return axis.set_point().loop == control::ServoLoop::off ||
                 axis.set_point().loop == control::ServoLoop::torque
             ? 0
             : rounded(axis.set_point().velocity);
}

constexpr auto kValues = std::to_array<ValueObject>({
    {0x200D, 0, [](const drive::ServoAxis& a) { return std::int64_t{a.flags().bits()}; }},
    {0x200E, 0,
     [](const drive::ServoAxis& a) {
       return std::clamp(rounded(10.0 * a.supply_voltage()), std::int64_t{0}, std::int64_t{1000});
     }},
    {0x200F, 0,
     [](const drive::ServoAxis& a) {
       return std::clamp(rounded(a.driver_temperature()), std::int64_t{-20}, std::int64_t{150});
     }},
    {0x2030, 1, [](const drive::ServoAxis& a) { return a.objects().torque_actual.get(); }},
    {0x2030, 2,
     [](const drive::ServoAxis& a) { return std::int64_t{a.controller().target_current()}; }},
    {0x2030, 3,
     [](const drive::ServoAxis& a) { return std::int64_t{a.controller().ramp_target_current()}; }},
    {0x2030, 6,
     [](const drive::ServoAxis& a) { return std::int64_t{a.controller().torque_error()}; }},
    {0x2030, 7,
     [](const drive::ServoAxis& a) { return std::int64_t{a.controller().torque_error_sum()}; }},
    {0x2030, 8,
     [](const drive::ServoAxis& a) { return std::int64_t{a.controller().flux_error()}; }},
    {0x2030, 9,
     [](const drive::ServoAxis& a) { return std::int64_t{a.controller().flux_error_sum()}; }},
    {0x2040, 1,
     [](const drive::ServoAxis& a) { return std::int64_t{a.objects().velocity_actual.get()}; }},
    {0x2040, 2, target_velocity},
    {0x2040, 3, ramp_velocity},
    {0x2040, 7,
     [](const drive::ServoAxis& a) { return std::int64_t{a.controller().velocity_error()}; }},
    {0x2040, 8,
     [](const drive::ServoAxis& a) { return std::int64_t{a.controller().velocity_error_sum()}; }},
    {0x2050, 1,
     [](const drive::ServoAxis& a) { return std::int64_t{a.objects().position_actual.get()}; }},
    {0x2050, 2,
     [](const drive::ServoAxis& a) { return std::int64_t{a.objects().target_position.get()}; }},
    {0x2050, 3,
     [](const drive::ServoAxis& a) { return std::int64_t{a.objects().position_demand.get()}; }},
    {0x2050, 5,
     [](const drive::ServoAxis& a) { return std::int64_t{a.controller().position_error()}; }},
    {0x2060, 1,
     [](const drive::ServoAxis& a) { return std::int64_t{a.controller().open_loop_angle()}; }},
    {0x2070, 1,
     [](const drive::ServoAxis& a) { return std::int64_t{a.controller().hall_angle()}; }},
    {0x2080, 1,
     [](const drive::ServoAxis& a) { return std::int64_t{a.controller().encoder_angle()}; }},
    {0x2095, 3, [](const drive::ServoAxis& a) { return std::int64_t{a.controller().i2t_sum()}; }},
    {0x2095, 4,
     [](const drive::ServoAxis& a) { return std::int64_t{a.controller().i2t_counter()}; }},
    {0x2100, 0, [](const drive::ServoAxis& a) { return a.home_offset_display(); }},
});

}  // namespace

ServoObjects::ServoObjects(dictionary::Dictionary& dictionary, const Options& options)
    : dictionary_(dictionary), options_(options) {
  using Written = Entry::WrittenHook;
  using Check = Entry::CheckHook;
  for (const Entry& entry : dictionary.entries()) {
    if (is_parameter(entry.index()) && entry.writable()) {
      dictionary.on_written(entry.index(), entry.subindex(),
                            Written::bind<&ServoObjects::note_change>(*this));
    }
  }
  for (const ValueObject& object : kValues) {
    dictionary.on_read(object.index, object.subindex,
                       Entry::ReadHook::bind<&ServoObjects::show>(*this));
  }
  const auto mirror = Written::bind<&ServoObjects::mirror_encoder_steps>(*this);
  const auto check_steps = Check::bind<&ServoObjects::check_encoder_steps>(*this);
  dictionary.on_written(0x2080, 2, mirror);
  dictionary.on_written(0x608F, 1, mirror);
  dictionary.on_check(0x2080, 2, check_steps);
  dictionary.on_check(0x608F, 1, check_steps);
  dictionary.on_check(0x2010, 1, Check::bind<&ServoObjects::check_poles>(*this));
  dictionary.on_check(0x2055, 0, Check::bind<&ServoObjects::check_commutation>(*this));
  dictionary.on_check(0x2050, 1, Check::bind<&ServoObjects::check_position>(*this));
  dictionary.on_written(0x2050, 1, Written::bind<&ServoObjects::place_position>(*this));
  dictionary.on_written(0x2095, 4, Written::bind<&ServoObjects::set_i2t_counter>(*this));
  dictionary.on_written(0x2095, 5, Written::bind<&ServoObjects::clear_i2t_exceeded>(*this));
  if (options.switches_fixed_while_on) {
    dictionary.on_check(0x2005, 0, Check::bind<&ServoObjects::check_switches>(*this));
  }
}

std::uint64_t ServoObjects::value(std::uint16_t index, std::uint8_t subindex) const {
  return dictionary_.find(index, subindex)->value();
}

void ServoObjects::take_over() {
  changed_ = false;
  const auto unsigned8 = [this](std::uint16_t index, std::uint8_t subindex = 0) {
    return static_cast<std::uint8_t>(value(index, subindex));
  };
  const auto unsigned16 = [this](std::uint16_t index, std::uint8_t subindex = 0) {
    return static_cast<std::uint16_t>(value(index, subindex));
  };
  const auto unsigned32 = [this](std::uint16_t index, std::uint8_t subindex = 0) {
    return static_cast<std::uint32_t>(value(index, subindex));
  };
  const auto is_set = [this](std::uint16_t index, std::uint8_t subindex = 0) {
    return value(index, subindex) != 0;
  };

  drive::ServoSettings& servo = axis_->servo_settings();
  control::ServoControllerSettings& controller = servo.controller;
  controller.pole_pairs = static_cast<std::uint8_t>(unsigned8(0x2010, 1) / 2);
  controller.commutation = static_cast<control::ServoCommutation>(unsigned8(0x2055));
  controller.torque_p = unsigned16(0x2030, 4);
  controller.torque_i = unsigned16(0x2030, 5);
  controller.velocity_p = unsigned16(0x2040, 5);
  controller.velocity_i = unsigned16(0x2040, 6);
  controller.position_p = unsigned16(0x2050, 4);
  controller.maximum_torque = unsigned32(0x2020, 1);
  controller.maximum_velocity = unsigned32(0x2020, 2);
  controller.open_loop_current = unsigned32(0x2060, 2);
  controller.motor_halted_velocity = unsigned32(0x2040, 4);
  controller.hall_inverted = is_set(0x2070, 2);
  controller.hall_interpolated = is_set(0x2070, 3);
  controller.encoder_steps = unsigned16(0x2080, 2);
  controller.encoder_offset = unsigned16(0x2080, 3);
  controller.encoder_reversed = is_set(0x2080, 4);
  controller.init_mode = static_cast<control::EncoderInitMode>(unsigned8(0x2080, 5));
  controller.init_delay = unsigned16(0x2080, 6);
  controller.init_velocity = static_cast<std::int32_t>(value(0x2080, 7));
  controller.brake_chopper_enabled = is_set(0x2090, 1);
  controller.brake_chopper_limit = unsigned16(0x2090, 2);
  controller.brake_chopper_hysteresis = unsigned16(0x2090, 3);
  controller.i2t_time_constant = unsigned32(0x2095, 1);
  controller.i2t_limit = unsigned32(0x2095, 2);
  servo.maximum_acceleration = unsigned32(0x2020, 3);
  servo.limits = limits_;
  servo.target_reached_velocity = unsigned32(0x2050, 6);
  servo.target_reached_distance = unsigned32(0x2050, 7);

  drive::AxisSettings& settings = axis_->settings();
  settings.ramp.active = is_set(0x2056);
  const unsigned switches = unsigned32(0x2005);
  settings.reference.switches = {
      .left = {.used = (switches & kLeftOff) == 0, .inverted = (switches & kLeftInverted) != 0},
      .right = {.used = (switches & kRightOff) == 0, .inverted = (switches & kRightInverted) != 0},
      .home = {.used = false}};
  settings.reference.home_offset_is_position = options_.home_offset_is_position;
  settings.hard_stop = {.current = 1e-3 * unsigned32(0x2025, 4),
                        .positive_clearance = static_cast<std::int32_t>(value(0x2025, 2)),
                        .negative_clearance = static_cast<std::int32_t>(value(0x2025, 3))};
}

void ServoObjects::show(Entry& entry) {
  const auto* const object = std::ranges::find_if(kValues, [&entry](const ValueObject& candidate) {
    return candidate.index == entry.index() && candidate.subindex == entry.subindex();
  });
  entry.set_value(static_cast<std::uint64_t>(object->read(*axis_)));
}

// 2080h:02 and 608Fh:01 are two names of one value.
void ServoObjects::mirror_encoder_steps(const Entry& entry) {
  const bool profile = entry.index() == 0x608F;
  dictionary_.find(profile ? 0x2080 : 0x608F, profile ? 2 : 1)->set_value(entry.value());
  changed_ = true;
}

void ServoObjects::place_position(const Entry& entry) {
  configure();
  axis_->set_position(axis_->motion().unscaled(entry.signed_value()));
}

void ServoObjects::set_i2t_counter(const Entry& entry) {
  axis_->set_i2t_counter(static_cast<std::uint32_t>(entry.value()));
}

void ServoObjects::clear_i2t_exceeded(const Entry& /*entry*/) {
  axis_->clear_i2t_exceeded();
}

ServoObjects::Verdict ServoObjects::check_poles(const Entry& entry, std::uint64_t bits) {
  if (bits % 2 != 0) {
    return dictionary::refuse(AbortCode::value_range_exceeded, kOddPoles,
                              {int{entry.index()}, int{entry.subindex()}, bits});
  }
  return {};
}

ServoObjects::Verdict ServoObjects::check_encoder_steps(const Entry& entry, std::uint64_t bits) {
  if (bits == 0) {
    return dictionary::refuse(AbortCode::value_range_exceeded, kNoEncoderSteps,
                              {int{entry.index()}, int{entry.subindex()}, bits});
  }
  return {};
}

ServoObjects::Verdict ServoObjects::check_commutation(const Entry& entry, std::uint64_t bits) {
  if (bits != entry.value() && axis_->power_state() == PowerState::operation_enabled) {
    return dictionary::refuse(AbortCode::device_state, kCommutationInUse,
                              {int{entry.index()}, int{entry.subindex()}, bits});
  }
  return {};
}

ServoObjects::Verdict ServoObjects::check_position(const Entry& entry, std::uint64_t bits) {
  const bool enabled = axis_->power_state() == PowerState::operation_enabled;
  const bool positioned =
      axis_->mode() == ModeCode::profile_position || axis_->mode() == ModeCode::homing;
  if ((enabled && positioned) || !axis_->controller().motor_halted()) {
    return dictionary::refuse(
        AbortCode::device_state, kPositionInUse,
        {int{entry.index()}, int{entry.subindex()}, static_cast<std::int64_t>(bits)});
  }
  return {};
}

ServoObjects::Verdict ServoObjects::check_switches(const Entry& entry, std::uint64_t bits) {
  if (axis_->power_state() != PowerState::switch_on_disabled) {
    return dictionary::refuse(AbortCode::device_state, kSwitchesInUse,
                              {int{entry.index()}, int{entry.subindex()}, bits});
  }
  return {};
}

double ServoObjects::position_demand() const {
  return static_cast<double>(axis_->motion().position());
}

double ServoObjects::position_actual() const {
  return static_cast<double>(axis_->actual_position());
}

double ServoObjects::current_demand() const {
  return 1e-3 * axis_->controller().ramp_target_current();
}

double ServoObjects::current_actual() const {
  return 1e-3 * axis_->controller().actual_current();
}

double ServoObjects::brake_chopper() const {
  return axis_->controller().brake_chopper_on() ? 1.0 : 0.0;
}

void ServoObjects::append_signals(std::vector<product::Signal>& signals) const {
  const auto add = [&](const char* name, const char* unit, base::SignalReader read) {
    signals.push_back({std::string("axis0.") + name, unit, read});
  };
  using Read = base::SignalReader;
  add("position_demand", "increment", Read::bind<&ServoObjects::position_demand>(*this));
  add("position_actual", "increment", Read::bind<&ServoObjects::position_actual>(*this));
  add("velocity_demand", "rpm", Read::bind<&ServoObjects::velocity_demand>(*this));
  add("velocity_actual", "rpm", Read::bind<&ServoObjects::velocity_actual>(*this));
  add("current_demand", "A", Read::bind<&ServoObjects::current_demand>(*this));
  add("current_actual", "A", Read::bind<&ServoObjects::current_actual>(*this));
  add("i2t_sum", "A2ms", Read::bind<&ServoObjects::i2t_sum>(*this));
  add("status_flags", "", Read::bind<&ServoObjects::status_flags>(*this));
  add("brake_chopper", "", Read::bind<&ServoObjects::brake_chopper>(*this));
  add("controlword", "", Read::bind<&ServoObjects::controlword>(*this));
  add("statusword", "", Read::bind<&ServoObjects::statusword>(*this));
  add("mode", "", Read::bind<&ServoObjects::mode>(*this));
}

}  // namespace stator::devices::tmcc160
