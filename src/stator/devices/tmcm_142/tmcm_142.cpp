#include "stator/devices/tmcm_142/tmcm_142.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "stator/can/frame.hpp"
#include "stator/devices/tmcm_142/parameters.hpp"
#include "stator/tmcl/module/global_parameter.hpp"

namespace stator::devices {

namespace {

using base::SimTime;
using tmcl::GlobalParameter;
using tmcm_142::ModuleParameter;

constexpr base::EventRule kDefaultsRestored{
    "tmcm142-defaults", base::Severity::warning,
    "the magic in global parameter 64 is not E4h: parameters, variables, coordinates and program "
    "were set to their factory defaults"};
constexpr base::EventRule kShutDown{
    "tmcm142-shutdown", base::Severity::fault,
    "the shutdown pin is active (global parameter 80 is {0}): motor stopped, power stage off; when "
    "it is released the motor stands until the next motion command"};

constexpr std::uint8_t kMaximumDipAddress = 15;
constexpr std::string_view kCan = "can";

std::invalid_argument invalid(const std::string& what) {
  return std::invalid_argument("TMCM-142: " + what);
}

void set_default(std::vector<tmcl::ParameterDeclaration>& rows, std::uint8_t number,
                 std::int32_t value) {
  for (tmcl::ParameterDeclaration& row : rows) {
    if (row.bank == tmcl::kConfigurationBank && row.number == number) {
      if (!row.range().contains(value)) {
        throw invalid("global parameter " + std::to_string(number) + " cannot be " +
                      std::to_string(value));
      }
      row.initial = value;
    }
  }
}

template <typename Rows>
std::vector<tmcl::ParameterDeclaration> copy_of(const Rows& rows) {
  return {rows.begin(), rows.end()};
}

}  // namespace

namespace tmcm_142 {

plant::StepperAxisParameters default_axis() {
  plant::StepperAxisParameters axis;
  // A stage for 5 A rms with heat spreader, where the plant's default is one for 3 A.
  axis.driver.on_resistance = 0.03;
  axis.driver.thermal.outer_capacity = 40.0;
  axis.driver.thermal.outer_to_ambient = 6.0;
  return axis;
}

}  // namespace tmcm_142

Tmcm142::Tables::Tables(const Tmcm142Configuration& configuration)
    : axis(copy_of(tmcm_142::axis_parameters())),
      global(copy_of(tmcm_142::global_parameters())),
      description(tmcm_142_description()) {
  const auto number = [](auto parameter) { return static_cast<std::uint8_t>(parameter); };
  set_default(global, number(GlobalParameter::serial_address), configuration.tmcl.serial);
  set_default(global, number(GlobalParameter::can_identifier), configuration.tmcl.can);
  set_default(global, number(GlobalParameter::can_reply_identifier), configuration.tmcl.can_reply);
  set_default(global, number(GlobalParameter::auto_start), configuration.auto_start ? 1 : 0);
  set_default(global, number(ModuleParameter::can_bit_rate), configuration.can_bit_rate);
  set_default(global, number(ModuleParameter::baud_rate), configuration.baud_rate);
  if (configuration.options.writable_encoder_position) {
    std::ranges::find(axis, number(tmcm_142::AxisParameter::encoder_position),
                      &tmcl::ParameterDeclaration::number)
        ->writable = true;
  }
  description.axis_parameters = axis;
  description.global_parameters = global;
  if (configuration.options.eight_input_bits) {
    description.input_bits = 0xFF;
  }
  if (configuration.program.size() > description.program_length) {
    throw invalid("a program of " + std::to_string(configuration.program.size()) +
                  " commands; the memory holds " + std::to_string(description.program_length));
  }
  if (configuration.instruction_time.nanoseconds() < 1) {
    throw invalid("the instruction time must be 1 ns at least");
  }
  const tmcm_142::DipSwitches& switches = configuration.dip_switches;
  if (switches.address > kMaximumDipAddress) {
    throw invalid("DIP switch 100 has values up to 15");
  }
  if (switches.interface && *switches.interface != kCan &&
      std::ranges::find(kSerialInterfaces, *switches.interface) == kSerialInterfaces.end()) {
    throw invalid("there is no interface \"" + *switches.interface + "\"");
  }
}

Tmcm142::Tmcm142(const Tmcm142Configuration& configuration, base::EventReporter reporter)
    : tables_(configuration),
      dip_switches_(configuration.dip_switches),
      reporter_(reporter),
      module_(tables_.axis, tables_.global, configuration.axis, configuration.options, reporter),
      firmware_(tables_.description, module_,
                {.instruction_time = configuration.instruction_time, .seed = configuration.seed},
                reporter),
      eeprom_(module_, firmware_, reporter),
      can_session_(firmware_, configuration.dip_switches.address),
      sessions_{tmcl::SerialSession(firmware_, {}, reporter),
                tmcl::SerialSession(firmware_, {}, reporter),
                tmcl::SerialSession(
                    firmware_, {.address_offset = configuration.dip_switches.address}, reporter),
                tmcl::SerialSession(firmware_, {.telegram_pause = false}, reporter)} {
  static_assert(kSerialInterfaces[kRs232] == "rs232" && kSerialInterfaces[kRs422] == "rs422" &&
                kSerialInterfaces[kUsb] == "usb");
  firmware_.load_program(configuration.program);
  power_on(SimTime());
}

void Tmcm142::connect_memory(canopen::NonVolatileMemory& memory) {
  eeprom_.connect(memory);
  power_on(SimTime());
}

bool Tmcm142::connect_serial(std::string_view interface, tmcl::SerialPort* port) {
  const auto* const found = std::ranges::find(kSerialInterfaces, interface);
  if (found == kSerialInterfaces.end()) {
    return false;
  }
  const auto place = static_cast<std::size_t>(found - kSerialInterfaces.begin());
  ports_[place] = port;
  sessions_[place].connect(works(interface) ? port : nullptr);
  return true;
}

void Tmcm142::power_on(SimTime now) {
  if (module_.power_on()) {
    firmware_.load_program({});
    reporter_.report(now, kDefaultsRestored);
  }
  shut_down_ = false;
  frames_wait_ = false;
  bit_rate_ = tmcm_142::kCanBitRates[static_cast<std::size_t>(
                                         module_.configuration(ModuleParameter::can_bit_rate)) -
                                     1];
  baud_rate_ = tmcm_142::kBaudRates[static_cast<std::size_t>(
      module_.configuration(ModuleParameter::baud_rate))];
  firmware_.power_on(now);
  controller_.clear();
  can_session_.power_on();
  set_filter();
  for (tmcl::SerialSession& session : sessions_) {
    session.power_on();
  }
}

void Tmcm142::set_power(bool on, SimTime now) {
  if (on == powered_) {
    return;
  }
  powered_ = on;
  if (on) {
    power_on(now);
    return;
  }
  eeprom_.abandon();
  module_.io().restart();
  firmware_.stop_program();
  controller_.clear();
}

std::optional<std::uint32_t> Tmcm142::baud_rate(std::string_view interface) const {
  return interface == kSerialInterfaces[kUsb] ? std::nullopt : std::optional(baud_rate_);
}

SimTime Tmcm142::next_serial_reply() const {
  SimTime next = SimTime::never();
  for (const tmcl::SerialSession& session : sessions_) {
    if (powered_ && session.connected()) {
      next = std::min({next, session.next_deadline(),
                       session.awaits_eeprom() ? eeprom_.next_poll() : SimTime::never()});
    }
  }
  return next;
}

SimTime Tmcm142::next_deadline() const {
  if (!powered_) {
    return SimTime::never();
  }
  SimTime deadline = can_session_.awaits_target() ? next_tick_ : SimTime::never();
  if (can_session_.awaits_eeprom() || frames_wait_) {
    deadline = std::min(deadline, eeprom_.next_poll());
  }
  for (const tmcl::SerialSession& session : sessions_) {
    if (session.connected()) {
      deadline = std::min({deadline, session.awaits_target() ? next_tick_ : session.next_deadline(),
                           session.awaits_eeprom() ? eeprom_.next_poll() : SimTime::never()});
    }
  }
  return deadline;
}

void Tmcm142::advance(SimTime now) {
  for (SimTime next = next_step(); next <= now; next = next_step()) {
    if (powered_) {
      firmware_.advance(next - base::SimDuration(1));
    }
    if (eeprom_.next_poll() <= next) {
      poll_eeprom(next);
    }
    if (next_tick_ <= next) {
      tick(next);
      next_tick_ += kControlPeriod;
    }
  }
  if (powered_) {
    firmware_.advance(now);
    serve_due(now);
  }
}

/// Order: first the answer to the host whose command wrote, then hosts that waited, then the
/// program.
void Tmcm142::poll_eeprom(SimTime now) {
  eeprom_.poll(now, next_tick_ > now ? next_tick_ : next_tick_ + kControlPeriod);
  if (!powered_ || eeprom_.outcome() == tmcm_142::Eeprom::Outcome::busy) {
    return;
  }
  for (tmcl::SerialSession& session : sessions_) {
    session.finish(now);
  }
  if (const auto reply = can_session_.finish(now)) {
    send(*reply);
  }
  firmware_.finish_instruction(now);
  for (tmcl::SerialSession& session : sessions_) {
    session.serve(now);
  }
  take_frames(now);
}

void Tmcm142::tick(SimTime now) {
  const bool shut_down = module_.shut_down();
  if (powered_ && shut_down && !shut_down_) {
    reporter_.report(now, kShutDown,
                     {module_.configuration(ModuleParameter::shutdown_pin_functionality)});
  }
  shut_down_ = shut_down;
  const tmcm_142::AxisEvents events = module_.axis().step(
      now, kControlPeriod,
      {.powered = powered_,
       .shut_down = shut_down,
       .step_direction_connected = ports_[kRs232] == nullptr || !works(kSerialInterfaces[kRs232])});
  eeprom_.service(now);
  if (!powered_) {
    return;
  }
  if (events.driver_error) {
    firmware_.raise(tmcl::ErrorFlag::external_alarm);
  }
  if (events.shut_down) {
    firmware_.raise(tmcl::ErrorFlag::shutdown);
  }
  if (events.deviation) {
    firmware_.raise(tmcl::ErrorFlag::deviation);
  }
  if (events.position_error) {
    firmware_.raise(tmcl::ErrorFlag::position);
  }
  set_filter();
  serve_due(now);
  tell_of_targets(now);
}

/// Sends replies that interfaces have held back and that are due.
void Tmcm142::serve_due(SimTime now) {
  for (tmcl::SerialSession& session : sessions_) {
    if (session.next_deadline() <= now) {
      session.serve(now);
    }
  }
}

/// In control periods only: between two of them a program may move the target to where the axis is,
/// and when a host hears of it must not depend on when the device is looked at.
void Tmcm142::tell_of_targets(SimTime now) {
  for (tmcl::SerialSession& session : sessions_) {
    if (session.awaits_target()) {
      session.serve(now);
    }
  }
  if (can_session_.awaits_target()) {
    if (const auto reply = can_session_.take_event()) {
      send(*reply);
    }
  }
}

void Tmcm142::handle_serial(SimTime now) {
  advance(now);
  discard_serial();
  if (!powered_) {
    return;
  }
  for (tmcl::SerialSession& session : sessions_) {
    session.serve(now);
  }
  set_filter();
}

/// What comes while the supply is off is lost, and what comes to an interface that the switches
/// have turned off.
void Tmcm142::discard_serial() {
  std::array<std::byte, 64> buffer{};
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    const bool heard = powered_ && sessions_[i].connected();
    while (!heard && ports_[i] != nullptr && ports_[i]->take(buffer) != 0) {
    }
  }
}

void Tmcm142::handle_bus_events(SimTime now) {
  take_frames(now);
}

/// While the EEPROM is written frames wait in the controller.
void Tmcm142::take_frames(SimTime now) {
  frames_wait_ = powered_ && firmware_.busy();
  while (!frames_wait_) {
    const std::optional<can::Frame> frame = controller_.take();
    if (!frame) {
      break;
    }
    if (!powered_ || frame->extended || frame->remote || !works(kCan)) {
      continue;  // A10
    }
    if (const auto reply = can_session_.take(frame->identifier, frame->payload(), now)) {
      send(*reply);
    }
    if (const auto reply = can_session_.take_event()) {
      send(*reply);
    }
    frames_wait_ = firmware_.busy();
  }
  set_filter();
}

/// Frames for others cost the module nothing.
void Tmcm142::set_filter() {
  const std::array<std::uint32_t, 2> identifiers = can_session_.identifiers();
  if (identifiers == accepted_) {
    return;
  }
  accepted_ = identifiers;
  can::AcceptanceFilter& filter = controller_.filter();
  filter.accept_none();
  filter.accept(identifiers[0]);
  if (identifiers[1] != 0) {
    filter.accept(identifiers[1]);
  }
}

void Tmcm142::send(const tmcl::CanReply& reply) {
  static_cast<void>(controller_.send(can::data_frame(reply.identifier, reply.payload())));
}

std::vector<product::Signal> Tmcm142::signals() const {
  std::vector<product::Signal> signals;
  module_.axis().append_signals(signals);
  module_.io().append_signals(signals);
  using Read = base::SignalReader;
  signals.push_back({"alarm", "", Read::bind<&Tmcm142::alarm>(*this)});
  signals.push_back({"power_led", "", Read::bind<&Tmcm142::power_led>(*this)});
  signals.push_back({"program_status", "", Read::bind<&Tmcm142::program_status>(*this)});
  signals.push_back({"program_counter", "", Read::bind<&Tmcm142::program_counter>(*this)});
  signals.push_back({"accumulator", "", Read::bind<&Tmcm142::accumulator>(*this)});
  signals.push_back({"eeprom_writes", "", Read::bind<&Tmcm142::eeprom_writes>(*this)});
  return signals;
}

std::vector<product::Input> Tmcm142::inputs() {
  std::vector<product::Input> inputs;
  module_.axis().append_inputs(inputs);
  module_.io().append_inputs(inputs);
  return inputs;
}

product::Indicators Tmcm142::indicators() const {
  product::Indicators all;
  all.add({"POWER", product::Indicator::Colour::green,
           powered_ ? base::LedPattern::on : base::LedPattern::off});
  return all;
}

}  // namespace stator::devices
