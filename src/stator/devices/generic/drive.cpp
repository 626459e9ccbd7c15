#include "stator/devices/generic/drive.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "stator/devices/generic/hexadecimal.hpp"
#include "stator/devices/tmc8670/objects.hpp"

namespace stator::devices::generic {

namespace {

using dictionary::Dictionary;
using dictionary::Entry;
using dictionary::ImportKind;
using dictionary::ImportReport;

constexpr std::uint16_t kControlword = 0x6040;
constexpr std::uint16_t kStatusword = 0x6041;
constexpr std::uint16_t kSupportedModes = 0x6502;
constexpr std::uint16_t kModesOfOperation = 0x6060;
constexpr std::uint32_t kServoUnits = 65536;  ///< per revolution, of an encoder as the servo has it
constexpr double kRpm = 60.0;

/// Gains and limits that fit the motor a drive has if nobody names another one, and the servo's
/// defaults of the profile in rpm and 1/65536 revolution.
constexpr auto kTuned = std::to_array<tmc8670::ObjectValue>({
    {0x2030, 1, 1453},   // P of flux and torque: 4000 rad/s with 0.6 mH, 1 mA and 24 V / sqrt 3
    {0x2030, 2, 786},    // I: the time constant of the winding, 0.6 mH / 0.36 ohm
    {0x2030, 3, 1453},   //
    {0x2030, 4, 786},    //
    {0x2030, 5, 6400},   // P of the velocity: 300 rad/s with 2.5e-5 kg m^2
    {0x2030, 6, 80},     // I: 60 rad/s
    {0x2030, 7, 300},    // P of the position: 80 rad/s
    {0x2031, 1, 12000},  // mA that torque and flux are limited to
    {0x2040, 1, 28000},  // mV at which the brake chopper starts and stops
    {0x2040, 2, 27000},
    {0x6072, 0, 2000},  // per mille
    {0x6073, 0, 2000},
    {0x6075, 0, 2450},  // mA RMS
    {0x6076, 0, 125},   // mN m
    {0x6098, 0, 35},    // home is where the shaft is: needs no switch
});

/// Arguments: {0} index, {1} subindex, {2} name, {3} the mode.
constexpr base::EventRule kModeNotThere{
    "generic-mode", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: 6502h of this device does not have mode {3}"};

/// Objects whose numbers count position units, velocity units, or those of acceleration; their
/// defaults follow the units.
constexpr auto kPositions = std::to_array<std::pair<std::uint16_t, std::uint8_t>>({{0x6067, 0}});
constexpr auto kVelocities = std::to_array<std::pair<std::uint16_t, std::uint8_t>>(
    {{0x607F, 0}, {0x6081, 0}, {0x6099, 1}, {0x6099, 2}});
constexpr auto kAccelerations = std::to_array<std::pair<std::uint16_t, std::uint8_t>>(
    {{0x6083, 0}, {0x6084, 0}, {0x6085, 0}, {0x609A, 0}});

/// Defaults that a drive is commissioned with, rpm and rpm/s.
constexpr double kProfileVelocity = 2000.0;
constexpr double kProfileAcceleration = 20000.0;
constexpr double kQuickStop = 50000.0;

/// Objects that say what the units are; the drive makes the servo's from them.
constexpr std::array<std::uint16_t, 5> kUnitObjects{0x608F, 0x6090, 0x6091, 0x6092, 0x6096};
/// Rated values of a motor that is another one: the servo keeps those of its own.
constexpr std::array<std::uint16_t, 3> kOfTheMotor{0x6075, 0x6076, 0x6080};

template <std::size_t Size>
bool is_one_of(const std::array<std::uint16_t, Size>& list, std::uint16_t index) {
  return std::ranges::find(list, index) != list.end();
}

std::uint64_t mask_of(std::size_t bits) {
  constexpr std::size_t kAll = 64;
  return bits >= kAll ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

/// The value of an integer type that is nearest to `value`, as an entry keeps it.
std::uint64_t saturated(dictionary::DataType type, std::int64_t value) {
  const std::size_t bits = dictionary::bit_length(type);
  constexpr std::size_t kAll = 64;
  if (bits == 0 || bits >= kAll) {
    return static_cast<std::uint64_t>(value);
  }
  const bool with_sign = dictionary::is_signed(type);
  const auto highest = static_cast<std::int64_t>(mask_of(with_sign ? bits - 1 : bits));
  const std::int64_t lowest = with_sign ? -highest - 1 : 0;
  return static_cast<std::uint64_t>(std::clamp(value, lowest, highest));
}

/// What `entry` shows of another entry's value. Types of the same length carry bits: some devices
/// have positions or modes without a sign.
std::uint64_t carried(const Entry& from, const Entry& to) {
  if (from.bits() == to.bits()) {
    const std::uint64_t bits = from.value() & mask_of(to.bits());
    const bool negative = dictionary::is_signed(to.type()) && (bits >> (to.bits() - 1)) != 0;
    return negative ? bits | ~mask_of(to.bits()) : bits;
  }
  return saturated(to.type(), from.signed_value());
}

std::uint64_t carried_bits(const Entry& from, std::uint64_t bits, const Entry& to) {
  if (from.bits() == to.bits()) {
    return bits & mask_of(to.bits());
  }
  auto value = static_cast<std::int64_t>(bits);
  // A code such as a homing method in a longer type without sign: -1 is FFFFFFFFh.
  const bool longer = from.bits() > to.bits() && !dictionary::is_signed(from.type());
  if (longer && dictionary::is_signed(to.type()) && (bits >> (from.bits() - 1)) != 0) {
    value = static_cast<std::int64_t>(bits | ~mask_of(from.bits()));
  }
  return saturated(to.type(), value);
}

bool is_integer(const Entry& entry) {
  using dictionary::DataType;
  return !dictionary::is_string(entry.type()) && entry.type() != DataType::real32 &&
         entry.type() != DataType::real64;
}

std::uint32_t rounded(double value) {
  constexpr double kHighest = std::numeric_limits<std::uint32_t>::max();
  return static_cast<std::uint32_t>(std::clamp(std::floor(value + 0.5), 1.0, kHighest));
}

void declare_servo(Dictionary& servo) {
  tmc8670::add_objects(servo);
  for (const tmc8670::ObjectValue& each : kTuned) {
    servo.set_default(each.index, each.subindex, each.bits);
  }
  servo.reset_values();
}

/// The servo's dictionary, declared before what binds itself to it.
Dictionary& declared(Dictionary& servo) {
  declare_servo(servo);
  return servo;
}

}  // namespace

bool is_drive(const Dictionary& objects, unsigned number) {
  constexpr std::size_t kWord = 16;
  const auto is_word = [&](std::uint16_t index) {
    const Entry* entry = objects.find(static_cast<std::uint16_t>(index + index_offset(number)), 0);
    return entry != nullptr && is_integer(*entry) && entry->bits() == kWord;
  };
  return is_word(kControlword) && is_word(kStatusword);
}

Drive::Drive(Dictionary& objects, unsigned number, const DriveUnits& units,
             const plant::PwmAxisParameters& parameters, base::EventReporter reporter,
             ImportReport* report)
    : objects_(objects),
      number_(number),
      units_(units),
      unit_(declared(servo_), parameters, reporter),
      errors_(servo_, tmc8670::kEmergencies) {
  follow_units();
  scale_defaults();
  link(report);
  restart(base::SimTime());
}

std::uint64_t Drive::object_value(std::uint16_t index, std::uint8_t subindex) const {
  const Entry* entry =
      objects_.find(static_cast<std::uint16_t>(index + index_offset(number_)), subindex);
  return entry != nullptr && is_integer(*entry) ? entry->value() & mask_of(entry->bits()) : 0;
}

// CiA 402-2 §7: position in user units = increments * feed / (increments per revolution * gear).
void Drive::follow_units() {
  const auto ratio = [this](std::uint16_t index) {
    const std::uint64_t numerator = object_value(index, 1);
    const std::uint64_t denominator = object_value(index, 2);
    return numerator != 0 && denominator != 0
               ? static_cast<double>(numerator) / static_cast<double>(denominator)
               : 0.0;
  };
  // One increment a revolution is what devices have there that do not say it.
  const double increments = ratio(0x608F) > 1.0 ? ratio(0x608F) : 0.0;
  const double gear = ratio(0x6091);
  const double feed = ratio(0x6092);
  double position = units_.position;
  if (position == 0.0) {
    const double per_turn = feed != 0.0 ? feed : increments;
    position = per_turn != 0.0 ? per_turn / (feed != 0.0 && gear != 0.0 ? gear : 1.0)
                               : static_cast<double>(kServoUnits);
  }
  position_units_ = rounded(position);
  velocity_units_ = units_.velocity != 0.0 ? units_.velocity : position_units_;
  unit_.set_velocity_units(velocity_units_);
  servo_.find(0x608F, 1)->set_value(position_units_);
  servo_.find(0x608F, 2)->set_value(1);
  servo_.set_default(0x608F, 1, position_units_);
  servo_.set_default(0x608F, 2, 1);
  servo_.set_default(0x2052, 2, std::numeric_limits<std::uint32_t>::max());
}

void Drive::scale_defaults() {
  const double per_rpm = velocity_units_ / kRpm;
  const auto set = [this](std::uint16_t index, std::uint8_t subindex, double value) {
    servo_.set_default(index, subindex, rounded(value));
  };
  for (const auto& [index, subindex] : kPositions) {
    const auto usual = static_cast<double>(servo_.find(index, subindex)->default_bits());
    set(index, subindex, usual * position_units_ / kServoUnits);
  }
  for (const auto& [index, subindex] : kVelocities) {
    const auto usual = static_cast<double>(servo_.find(index, subindex)->default_bits());
    set(index, subindex, (index == 0x6081 ? kProfileVelocity : usual) * per_rpm);
  }
  for (const auto& [index, subindex] : kAccelerations) {
    set(index, subindex, (index == 0x6085 ? kQuickStop : kProfileAcceleration) * per_rpm);
  }
}

void Drive::link(ImportReport* report) {
  const std::uint16_t offset = index_offset(number_);
  const auto first = static_cast<std::uint16_t>(0x6000 + offset);
  const auto last = static_cast<std::uint16_t>(0x67FF + offset);
  for (const dictionary::Object& object : objects_.objects()) {
    if (object.index < first || object.index > last) {
      continue;
    }
    for (Entry& entry : objects_.entries_of(object)) {
      link_entry(entry, report);
    }
  }
}

// Nobody can write it, so that the drive has to be in a mode by itself.
void Drive::choose_only_mode(Entry& entry, ImportReport* report) {
  constexpr unsigned kCyclicSynchronousPosition = 8;
  const std::uint64_t modes = object_value(kSupportedModes, 0);
  const bool cyclic = modes == 0 || (modes >> (kCyclicSynchronousPosition - 1) & 1U) != 0;
  const unsigned mode =
      cyclic ? kCyclicSynchronousPosition : static_cast<unsigned>(std::countr_zero(modes)) + 1;
  objects_.set_default(entry.index(), entry.subindex(), mode);
  if (report != nullptr) {
    report->add(ImportKind::assumed, 0, "drive-mode",
                hexadecimal(entry.index(), 4) +
                    "h cannot be written and has no value; the drive is in mode " +
                    std::to_string(mode));
  }
}

void Drive::link_entry(Entry& entry, ImportReport* report) {
  const auto index = static_cast<std::uint16_t>(entry.index() - index_offset(number_));
  if (is_one_of(kUnitObjects, index)) {
    objects_.on_written(entry.index(), entry.subindex(),
                        Entry::WrittenHook::bind<&Drive::units_written>(*this));
    return;
  }
  Entry* servo = servo_.find(index, entry.subindex());
  if (servo == nullptr || !is_integer(entry) || is_one_of(kOfTheMotor, index) ||
      (entry.subindex() == 0 &&
       entry.declaration().object_code != dictionary::ObjectCode::variable)) {
    return;
  }
  const Link made{.device = &entry, .servo = servo};
  if (index == kSupportedModes) {
    if (entry.default_bits() == 0) {
      objects_.set_default(entry.index(), 0, carried(*servo, entry));
    }
    return;
  }
  if (!servo->writable()) {
    shown_.push_back(made);
    return;
  }
  commands_.push_back(made);
  objects_.on_check(entry.index(), entry.subindex(),
                    Entry::CheckHook::bind<&Drive::command>(*this));
  if (index == kModesOfOperation && !entry.writable() && entry.default_bits() == 0) {
    choose_only_mode(entry, report);
  }
  choose_defaults(made, report);
}

void Drive::choose_defaults(const Link& link, ImportReport* report) {
  // What masters command starts as the file says, or with nothing, and is obeyed as if it were
  // written then; what a commissioning leaves behind is the servo's own default as well.
  constexpr std::array<std::uint16_t, 9> kTargets{0x6040, 0x6060, 0x607A, 0x6071, 0x60FF,
                                                  0x60B0, 0x60B1, 0x60B2, 0x607C};
  if (is_one_of(kTargets, link.servo->index())) {
    return;
  }
  const std::uint64_t own = link.device->default_bits();
  if (own != 0) {
    const std::uint64_t bits = carried_bits(*link.device, own, *link.servo);
    if (servo_.write_from_pdo(*link.servo, bits)) {
      servo_.set_default(link.servo->index(), link.servo->subindex(), link.servo->value());
    }
    return;
  }
  if (link.servo->default_bits() == 0) {
    return;
  }
  const std::uint64_t bits =
      saturated(link.device->type(), static_cast<std::int64_t>(link.servo->default_bits()));
  objects_.set_default(link.device->index(), link.device->subindex(), bits);
  if (report != nullptr) {
    report->add(ImportKind::assumed, 0, "drive-default",
                hexadecimal(link.device->index(), 4) + "h \"" + std::string(link.device->name()) +
                    "\" has no default in the file; it starts with " +
                    std::to_string(static_cast<std::int64_t>(bits)));
  }
}

dictionary::Verdict Drive::command(const Entry& entry, std::uint64_t bits) {
  const auto index = static_cast<std::uint16_t>(entry.index() - index_offset(number_));
  Entry* servo = servo_.find(index, entry.subindex());
  if (index == kModesOfOperation) {
    const std::uint64_t modes = object_value(kSupportedModes, 0);
    const auto mode = static_cast<std::int8_t>(bits);
    if (modes != 0 && mode > 0 && (modes >> (mode - 1) & 1U) == 0) {
      return dictionary::refuse(
          dictionary::AbortCode::value_range_exceeded, kModeNotThere,
          {base::EventArgument(int{entry.index()}), base::EventArgument(int{entry.subindex()}),
           entry.shared_name(), base::EventArgument(int{mode})});
    }
  }
  return servo_.write_from_pdo(*servo, carried_bits(entry, bits, *servo));
}

void Drive::restart(base::SimTime /*now*/) {
  servo_.reset_values();
  follow_units();
  errors_.restart();
  unit_.restart();
  for (const Link& each : commands_) {
    static_cast<void>(servo_.write_from_pdo(
        *each.servo, carried_bits(*each.device, each.device->value(), *each.servo)));
  }
  show();
}

bool Drive::apply(base::SimTime now) {
  if (!unit_.apply(now)) {
    return false;
  }
  show();
  return true;
}

void Drive::tick(base::SimTime now) {
  unit_.tick(now);
  show();
}

void Drive::step_world(base::SimTime until) {
  while (next_period_ <= until) {
    const base::SimDuration period = unit_.pwm_period();
    unit_.step(next_period_);
    next_period_ += period;
  }
}

void Drive::show() {
  unit_.refresh_objects();
  for (const Link& each : shown_) {
    each.device->set_value(carried(*each.servo, *each.device));
  }
}

std::string Drive::renamed(const std::string& name) const {
  constexpr std::string_view kFirst = "axis0.";
  return name.starts_with(kFirst)
             ? "axis" + std::to_string(number_) + "." + name.substr(kFirst.size())
             : name;
}

void Drive::append_signals(std::vector<product::Signal>& signals) const {
  std::vector<product::Signal> own;
  unit_.append_signals(own);
  for (product::Signal& each : own) {
    each.name = renamed(each.name);
    signals.push_back(std::move(each));
  }
}

void Drive::append_inputs(std::vector<product::Input>& inputs) {
  std::vector<product::Input> own;
  unit_.append_inputs(own);
  for (product::Input& each : own) {
    each.name = renamed(each.name);
    inputs.push_back(std::move(each));
  }
}

}  // namespace stator::devices::generic
