#include "stator/devices/tmc8670/tmc8670.hpp"

#include <algorithm>
#include <utility>

#include "stator/devices/tmc8670/emergencies.hpp"
#include "stator/devices/tmc8670/identity.hpp"
#include "stator/devices/tmc8670/internal/firmware_version.hpp"
#include "stator/devices/tmc8670/parameter_groups.hpp"
#include "stator/product/shell/coe_stack.hpp"

namespace stator::devices {

namespace {

using base::EventArgument;
using base::SimDuration;
using base::SimTime;
using ethercat::AlState;
using ethercat::AlStatusCode;

constexpr SimDuration kSync0Interrupt{50'000};
constexpr SimDuration kSync0Grace{62'500};  // half a period of the firmware

/// Argument: {0} bytes.
constexpr base::EventRule kNewFirmware{
    "tmc8670-new-firmware", base::Severity::information,
    "restarting with a new firmware image, {0} bytes; the virtual chip keeps the image and behaves "
    "as before, it does not run it"};
/// Arguments: {0} degree Celsius, {1} the limit.
constexpr base::EventRule kJunctionHot{
    "tmc8670-junction-hot", base::Severity::warning,
    "the junction has {0} degrees Celsius, operation is specified up to {1}; cool the chip"};
constexpr base::EventRule kJunctionBroken{
    "tmc8670-junction-maximum", base::Severity::fault,
    "the junction has {0} degrees Celsius, more than the absolute maximum of {1}: the chip stops "
    "until its supply is switched off and on"};

/// Declares the objects with the defaults this chip is delivered with.
dictionary::Dictionary& declare(dictionary::Dictionary& dictionary,
                                const Tmc8670Configuration& configuration) {
  tmc8670::add_objects(dictionary);
  for (const tmc8670::ObjectValue& object : configuration.objects) {
    dictionary.set_default(object.index, object.subindex, object.bits);
  }
  dictionary.set_default(0x1018, 4, configuration.serial_number);
  dictionary.reset_values();
  return dictionary;
}

}  // namespace

Tmc8670::Tmc8670(const Tmc8670Configuration& configuration, base::EventReporter reporter)
    : configuration_(configuration),
      reporter_(reporter),
      description_(tmc8670::describe(configuration)),
      controller_(tmc8670::controller_of(configuration)),
      axis_(declare(dictionary_, configuration), configuration.axis, reporter),
      supply_(reporter),
      stack_(controller_, dictionary_, description_, *this, reporter,
             tmc8670::stack_options(configuration, firmware_)),
      storage_(dictionary_, memory_, reporter,
               {tmc8670::kParameterGroups, tmc8670::kStorageCommands}),
      synchronisation_(dictionary_, reporter),
      hardware_uart_(axis_.stage().block()),
      mcu_uart_(dictionary_, kFirmwareCapacity, reporter),
      error_report_(dictionary_, tmc8670::kEmergencies) {
  stack_.set_write_completion(&storage_);
  dictionary_.on_read(0x100A, 0, dictionary::Entry::ReadHook::bind<&Tmc8670::show_version>(*this));
  controller_.set_event_reporter(reporter);
  controller_.load_sii(
      product::coe_sii_image(description_, dictionary_, configuration.coe, configuration.quirks));
}

void Tmc8670::show_version(dictionary::Entry& entry) {
  entry.set_text(tmc8670::firmware_version(firmware_.image()));
}

void Tmc8670::connect_memory(canopen::NonVolatileMemory& memory) {
  memory_.connect(memory);
  restart_firmware(SimTime());
}

void Tmc8670::advance(SimTime now) {
  while (true) {
    const SimTime edge = controller_.next_sync_edge(0);
    const SimTime sync0 = edge >= sync0_earliest_ ? edge : SimTime::never();
    const SimTime tick_time = powered_ ? next_tick_ : SimTime::never();
    const SimTime next = std::min({sync0, tick_time, next_period_});
    if (next > now) {
      break;
    }
    if (next == sync0) {
      sync0_earliest_ = sync0 + kSync0Interrupt;
      controller_.advance(sync0);
      if (powered_ && !mcu_uart_.in_boot_loader()) {
        take_sync0(sync0);
      }
    } else if (next == tick_time) {
      tick(tick_time);
    } else {
      const SimDuration period = axis_.pwm_period();
      axis_.step(next_period_);
      next_period_ += period;
    }
  }
  controller_.advance(now);
}

void Tmc8670::tick(SimTime now) {
  controller_.advance(now);
  next_tick_ = now + kControlPeriod;
  if (mcu_uart_.in_boot_loader()) {
    run_boot_loader(now);
    return;
  }
  process_bus(now);
  // A SYNC0 that stays away is waited for half a period, then the axis goes on without it.
  if (stack_.synchronous() && --ticks_to_sync_ == 0) {
    next_tick_ += kSync0Grace;
  }
  run_axis(now);
  hardware_uart_.serve(now);
  mcu_uart_.serve(now);
  if (!stack_.synchronous()) {
    outputs_came_ = false;
    stack_.publish_inputs(now);
  }
}

void Tmc8670::run_axis(SimTime now) {
  axis_.tick(now);
  report_errors(now);
  watch_junction(now);
}

void Tmc8670::take_sync0(SimTime now) {
  const std::uint64_t pulses = controller_.sync_pulse_count(0);
  if (std::exchange(sync0_pulses_, pulses) != pulses) {
    stack_.sync0(now);
  }
}

void Tmc8670::on_sync0(SimTime now) {
  synchronisation_.count_pulse();
  next_tick_ = now + kControlPeriod;
  ticks_to_sync_ = std::max<std::int64_t>(stack_.clocks().cycle() / kControlPeriod - 1, 0);
  if (ticks_to_sync_ == 0) {
    next_tick_ += kSync0Grace;
  }
  outputs_came_ = false;
  run_axis(now);
  stack_.publish_inputs(now);
}

void Tmc8670::run_boot_loader(SimTime now) {
  if (mcu_uart_.take_boot_request()) {
    stop_firmware(now);
  }
  hardware_uart_.serve(now);
  mcu_uart_.serve(now);
  if (!mcu_uart_.start_requested()) {
    return;
  }
  if (const std::span<const std::byte> image = mcu_uart_.loaded_image(); !image.empty()) {
    // It fits, since the boot loader has no more memory; what cannot be kept leaves the old one.
    static_cast<void>(firmware_.open_for_writing("mcu-uart"));
    static_cast<void>(firmware_.append(image));
    static_cast<void>(firmware_.commit());
    reporter_.report(now, kNewFirmware, {EventArgument(image.size())});
  }
  restart_firmware(now);
}

bool Tmc8670::connect_serial(std::string_view interface, tmcl::SerialPort* port) {
  if (interface == kSerialInterfaces[0]) {
    mcu_uart_.connect(port);
  } else if (interface == kSerialInterfaces[1]) {
    hardware_uart_.connect(port);
  } else {
    return false;
  }
  return true;
}

void Tmc8670::handle_serial(SimTime now) {
  if (powered_) {
    hardware_uart_.serve(now);
  }
}

std::optional<std::uint32_t> Tmc8670::baud_rate(std::string_view interface) const {
  return interface == kSerialInterfaces[1] ? hardware_uart_.baud_rate()
                                           : tmc8670::McuUart::kBaudRate;
}

void Tmc8670::set_power(bool on, SimTime now) {
  supply_.switch_on(on, now);
  controller_.hold_reset(on && !supply_.good());
  restart_chip(on && supply_.good(), now);
}

void Tmc8670::take_logic_supply(SimTime now) {
  const bool good = supply_.good();
  if (supply_.switched_on() && controller_.held_in_reset() == good) {
    controller_.hold_reset(!good);
    restart_chip(good, now);
  }
}

void Tmc8670::restart_chip(bool powered, SimTime now) {
  powered_ = powered;
  axis_.world().set_power(powered);
  // Without power the axis is what it is before the firmware has started: switched off.
  restart_firmware(now);
  hardware_uart_.restart();
  next_tick_ = now + kControlPeriod;
  static_cast<void>(controller_.take_reset_request());
}

void Tmc8670::handle_bus_events(SimTime now) {
  if (!powered_ || mcu_uart_.in_boot_loader()) {
    return;
  }
  if (controller_.take_reset_request()) {
    restart_firmware(now);
  }
  take_sync0(now);  // one that the frame has overtaken
  process_bus(now);
  apply_commands(now);
  if (outputs_came_) {
    outputs_came_ = false;
    stack_.publish_inputs(now);
  }
}

void Tmc8670::process_bus(SimTime now) {
  synchronisation_.refresh(stack_);
  stack_.process(now);
  if (restart_due_) {
    reporter_.report(now, kNewFirmware, {EventArgument(firmware_.size())});
    restart_firmware(now);
  }
}

void Tmc8670::restart_firmware(SimTime now) {
  downloads_in_force_ = firmware_.downloads();
  mcu_uart_.restart();
  stop_firmware(now);
}

void Tmc8670::stop_firmware(SimTime now) {
  restart_due_ = false;
  dictionary_.reset_values();
  synchronisation_.forget_wishes();
  storage_.load(now);
  error_report_.restart();
  junction_hot_ = false;
  axis_.restart();
  stack_.reset(now);
}

void Tmc8670::apply_commands(SimTime now) {
  if (!stack_.synchronous() && axis_.apply(now)) {
    report_errors(now);
  }
}

AlStatusCode Tmc8670::permit_state(AlState /*from*/, AlState to, SimTime now) {
  return to == AlState::operational ? synchronisation_.permit_operational(stack_, now)
                                    : AlStatusCode::no_error;
}

void Tmc8670::on_state(AlState from, AlState to, SimTime now) {
  if (from == AlState::bootstrap) {
    restart_due_ = firmware_.downloads() != downloads_in_force_;
  }
  if (to == AlState::init) {
    synchronisation_.forget_wishes();
  }
  const bool operational = to == AlState::operational;
  if (operational || from == AlState::operational) {
    axis_.set_network_operational(operational, now);
  }
  synchronisation_.refresh(stack_);
}

void Tmc8670::on_outputs(SimTime /*now*/) {
  outputs_came_ = true;
}

void Tmc8670::before_inputs(SimTime /*now*/) {
  axis_.refresh_objects();
  synchronisation_.refresh(stack_);
}

void Tmc8670::on_output_refused(const dictionary::Entry& /*entry*/,
                                const dictionary::Refusal& /*refusal*/, SimTime now) {
  namespace bits = drive::error_register;
  send_emergency(tmc8670::kParameterError, bits::kGeneric | bits::kDeviceProfile, 0, now);
}

void Tmc8670::report_errors(SimTime now) {
  error_report_.update(axis_.axis(), [&](const drive::AxisEmergency& row) {
    send_emergency(row.code, row.register_bits, row.detail, now);
  });
}

void Tmc8670::watch_junction(SimTime now) {
  const double celsius = axis_.world().junction_temperature();
  if (celsius > tmc8670::kJunctionMaximum) [[unlikely]] {
    reporter_.report(now, kJunctionBroken,
                     {static_cast<int>(celsius), static_cast<int>(tmc8670::kJunctionMaximum)});
    restart_chip(false, now);
    return;
  }
  const bool hot = celsius > tmc8670::kJunctionOperating;
  if (hot && !junction_hot_) [[unlikely]] {
    namespace bits = drive::error_register;
    reporter_.report(now, kJunctionHot,
                     {static_cast<int>(celsius), static_cast<int>(tmc8670::kJunctionOperating)});
    send_emergency(0x4210, bits::kGeneric | bits::kTemperature, 1, now);
  }
  junction_hot_ = hot;
}

void Tmc8670::send_emergency(std::uint16_t code, std::uint8_t register_bits, std::uint8_t detail,
                             SimTime now) {
  const auto bits = static_cast<std::uint8_t>(error_report_.error_register() | register_bits);
  stack_.send_emergency(code, bits, {detail, 0, 0, 0, 0}, now);
}

}  // namespace stator::devices
