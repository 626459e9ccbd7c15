// What the pins of a TMC8461 show: lines to the controller beside it, signals, inputs.

#include <algorithm>
#include <iterator>
#include <string>

#include "stator/base/byte_order.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/ethercat/units/led.hpp"

namespace stator::devices {

namespace {

using base::SimDuration;
using base::SimTime;

/// All patterns of status LEDs change at multiples of this (ETG.1300).
constexpr SimDuration kLedStep{50'000'000};
/// A link LED flickers for so long after a frame.
constexpr SimDuration kActivity{100'000'000};
constexpr SimDuration kSyncLengthUnit{10};
constexpr product::HostLines kLeds = product::host_line(product::HostLine::run_led) |
                                     product::host_line(product::HostLine::error_led) |
                                     product::host_line(product::HostLine::link_activity0) |
                                     product::host_line(product::HostLine::link_activity1);
constexpr std::array kSyncLines{product::host_line(product::HostLine::sync0),
                                product::host_line(product::HostLine::sync1)};
constexpr std::array<const char*, product::kHostPins> kPinNames{"latch_in0", "latch_in1", "mfc_nes",
                                                                "nreset"};

/// "mfcio07", "mfc_hv3".
std::string pin_name(std::size_t line) {
  std::string name(mfc::kLineNames[line]);
  std::ranges::transform(name, name.begin(), [](char letter) {
    return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  });
  return name;
}

product::HostLines shown(bool level, product::HostLine line) {
  return level ? product::host_line(line) : product::HostLines{0};
}

}  // namespace

product::HostLines Tmc8461::levels() {
  if (!running()) {
    return shown(powered_, product::HostLine::power);
  }
  std::array<std::byte, 1> status{};
  controller_.peek(ethercat::register_address::kDlStatus, status);
  const bool loaded = (status[0] & std::byte{1}) != std::byte{0};
  const unsigned levels =
      shown(controller_.host_interrupt(), product::HostLine::interrupt) |
      shown(controller_.sync_output(0), product::HostLine::sync0) |
      shown(controller_.sync_output(1), product::HostLine::sync1) |
      shown(reset_out_, product::HostLine::reset_out) |
      shown(loaded, product::HostLine::eeprom_loaded) |
      shown(lit(controller_.run_led()), product::HostLine::run_led) |
      shown(lit(controller_.error_led()), product::HostLine::error_led) |
      shown(link_led(0), product::HostLine::link_activity0) |
      shown(link_led(1), product::HostLine::link_activity1) |
      shown(controller_.process_data_watchdog_state(), product::HostLine::watchdog_state) |
      shown(io_.interrupt_pin(), product::HostLine::mfc_interrupt) |
      shown(true, product::HostLine::power);
  return static_cast<product::HostLines>(levels);
}

/// All LEDs keep one time, the simulated one, so that what is seen does not depend on who looked
/// before.
bool Tmc8461::lit(ethercat::LedCode code) const {
  return ethercat::led_lit(code, now_ - SimTime());
}

// ETG.1300: on with a link, flickering while frames pass.
bool Tmc8461::link_led(unsigned port) const {
  if (!controller_.link(port)) {
    return false;
  }
  const bool active = last_frame_ != SimTime::never() && now_ - last_frame_ < kActivity;
  return !active || lit(ethercat::LedCode::flickering);
}

void Tmc8461::watch(product::HostLines watched, product::HostLineSink* sink) {
  watched_ = sink != nullptr ? watched : product::HostLines{0};
  sink_ = sink;
  reported_levels_ = levels();
  for (unsigned output = 0; output < sync_counts_.size(); ++output) {
    sync_counts_[output] = controller_.sync_pulse_count(output);
    sync_ends_[output] = SimTime::never();
  }
}

SimTime Tmc8461::next_line_change() {
  if (watched_ == 0 || !powered_) {
    return SimTime::never();
  }
  SimTime next = controller_.next_deadline();
  if ((watched_ & product::host_line(product::HostLine::mfc_interrupt)) != 0) {
    next = std::min({next, io_.next_event(), board_.next_event()});
  }
  for (unsigned output = 0; output < kSyncLines.size(); ++output) {
    if ((watched_ & kSyncLines[output]) != 0) {
      next = std::min({next, controller_.next_sync_edge(output), sync_ends_[output]});
    }
  }
  return (watched_ & kLeds) != 0 ? std::min(next, next_led_edge()) : next;
}

SimTime Tmc8461::next_led_edge() const {
  const std::int64_t steps = (now_ - SimTime()).nanoseconds() / kLedStep.nanoseconds();
  return SimTime() + SimDuration((steps + 1) * kLedStep.nanoseconds());
}

void Tmc8461::publish(product::HostLines pulses) {
  if (sink_ == nullptr) {
    return;
  }
  pulses |= sync_pulses();
  product::HostLineChange change;
  change.time = now_;
  change.levels = levels();
  change.rose =
      static_cast<product::HostLines>(((change.levels & ~reported_levels_) | pulses) & watched_);
  change.fell = static_cast<product::HostLines>(
      ((reported_levels_ & ~change.levels) | (pulses & ~change.levels)) & watched_);
  reported_levels_ = change.levels;
  if ((change.rose | change.fell) != 0) {
    sink_->on_lines(change);
  }
}

/// SYNC outputs with a pulse since last time.
product::HostLines Tmc8461::sync_pulses() {
  unsigned pulses = 0;
  for (unsigned output = 0; output < kSyncLines.size(); ++output) {
    if ((watched_ & kSyncLines[output]) == 0) {
      continue;
    }
    const std::uint64_t count = controller_.sync_pulse_count(output);
    if (count != sync_counts_[output]) {
      sync_counts_[output] = count;
      pulses |= kSyncLines[output];
      std::array<std::byte, 2> length{};
      controller_.peek(ethercat::register_address::kSyncPulseLength, length);
      const std::int64_t units = base::load_le<std::uint16_t>(length.data());
      sync_ends_[output] = units != 0 && controller_.sync_output(output)
                               ? now_ + kSyncLengthUnit * units
                               : SimTime::never();
    } else if (sync_ends_[output] <= now_) {
      sync_ends_[output] = SimTime::never();
    }
  }
  return static_cast<product::HostLines>(pulses);
}

double Tmc8461::Probe::level() const {
  return (chip->levels() >> number & 1U) != 0 ? 1.0 : 0.0;
}

void Tmc8461::Probe::drive(double value) const {
  chip->set_pin(static_cast<product::HostPin>(number), value >= 0.5);
}

/// 0, 1, or 0.5 for a pin that floats.
double Tmc8461::Probe::io_level() const {
  switch (chip->io().pin(number)) {
    case mfc::PinState::low:
      return 0.0;
    case mfc::PinState::high:
      return 1.0;
    case mfc::PinState::floating:
      break;
  }
  return 0.5;
}

/// 0 and 1 are levels; between them nothing is connected.
void Tmc8461::Probe::drive_io(double value) const {
  constexpr double kLow = 0.25;
  constexpr double kHigh = 0.75;
  const bool open = value > kLow && value < kHigh;
  chip->io().drive(number, open ? mfc::OutsideDrive{} : mfc::OutsideDrive::level(value >= kHigh),
                   chip->now_);
}

double Tmc8461::al_state() const {
  std::array<std::byte, 1> status{};
  controller_.peek(ethercat::register_address::kAlStatus, status);
  return std::to_integer<unsigned>(status[0]);
}

double Tmc8461::pdi_errors() const {
  std::array<std::byte, 1> count{};
  controller_.peek(ethercat::register_address::kPdiErrors, count);
  return std::to_integer<unsigned>(count[0]);
}

/// PDI_SPI_IRQ as 0150h 3:2 has it drive the pin (L3529-L3539): 0, 1, or 0.5 where it floats. To
/// the host beside it the line tells of requests, whatever their polarity.
double Tmc8461::interrupt_pin() const {
  constexpr double kFloating = 0.5;
  if (!running()) {
    return kFloating;
  }
  std::array<std::byte, 1> configuration{};
  controller_.peek(ethercat::register_address::kPdiConfiguration, configuration);
  const bool open = (configuration[0] & std::byte{0x04}) != std::byte{0};
  const bool active_high = (configuration[0] & std::byte{0x08}) != std::byte{0};
  const bool requests = controller_.host_interrupt();
  if (open && !requests) {
    return kFloating;
  }
  return requests == active_high ? 1.0 : 0.0;
}

std::vector<product::Signal> Tmc8461::signals() const {
  std::vector<product::Signal> all{
      {"al_state", "", base::SignalReader::bind<&Tmc8461::al_state>(*this)},
      {"pdi_errors", "", base::SignalReader::bind<&Tmc8461::pdi_errors>(*this)},
      {"pdi_spi_irq", "", base::SignalReader::bind<&Tmc8461::interrupt_pin>(*this)}};
  for (const Probe& probe : line_probes_) {
    all.push_back({std::string(product::kHostLineNames[probe.number]), "",
                   base::SignalReader::bind<&Probe::level>(probe)});
  }
  for (const Probe& probe : io_probes_) {
    all.push_back({pin_name(probe.number), "", base::SignalReader::bind<&Probe::io_level>(probe)});
  }
  std::ranges::move(board_.signals(), std::back_inserter(all));
  return all;
}

std::vector<product::Input> Tmc8461::inputs() {
  std::vector<product::Input> all;
  // Their levels as they are before anybody sets one: a rack asks for inputs first.
  for (Probe& probe : pin_probes_) {
    all.push_back({kPinNames[probe.number], "", 0.0, 1.0,
                   base::Delegate<void(double)>::bind<&Probe::drive>(probe),
                   product::InputGroup::lines, pins_[probe.number] ? 1.0 : 0.0});
  }
  for (Probe& probe : io_probes_) {
    all.push_back({pin_name(probe.number), "", 0.0, 1.0,
                   base::Delegate<void(double)>::bind<&Probe::drive_io>(probe),
                   product::InputGroup::lines, 0.5});
  }
  all.push_back(clock_deviation_input());
  std::ranges::move(board_.inputs(), std::back_inserter(all));
  return all;
}

}  // namespace stator::devices
