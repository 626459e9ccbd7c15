#include "stator/devices/tmc8670/tmc8670.hpp"

#include <algorithm>

#include "stator/devices/tmc8670/emergencies.hpp"
#include "stator/devices/tmc8670/identity.hpp"
#include "stator/devices/tmc8670/internal/firmware_version.hpp"
#include "stator/devices/tmc8670/parameter_groups.hpp"
#include "stator/product/shell/coe_stack.hpp"

namespace stator::devices {

namespace {

using base::SimDuration;
using base::SimTime;
using ethercat::AlState;
using ethercat::AlStatusCode;

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
void declare(dictionary::Dictionary& dictionary, const Tmc8670Configuration& configuration) {
  tmc8670::add_objects(dictionary);
  for (const tmc8670::ObjectValue& object : configuration.objects) {
    dictionary.set_default(object.index, object.subindex, object.bits);
  }
  dictionary.set_default(0x1018, 4, configuration.serial_number);
  dictionary.reset_values();
}

product::EtherCatFirmwareParts parts(const Tmc8670Configuration& configuration) {
  return {.description = tmc8670::describe(configuration),
          .controller = tmc8670::controller_of(configuration),
          .stack = tmc8670::stack_options(configuration),
          .coe = configuration.coe,
          .quirks = configuration.quirks,
          .rules = {.control_period = tmc8670::AxisUnit::kControlPeriod,
                    .step_before_tick = false,
                    .periods_follow_sync0 = true,
                    .firmware_capacity = Tmc8670::kFirmwareCapacity,
                    .new_firmware = &kNewFirmware}};
}

}  // namespace

Tmc8670::Tmc8670(const Tmc8670Configuration& configuration, base::EventReporter reporter)
    : EtherCatFirmware(
          parts(configuration),
          [&](dictionary::Dictionary& objects) { declare(objects, configuration); }, reporter),
      axis_(objects(), configuration.axis, reporter),
      supply_(reporter),
      storage_(objects(), memory_, reporter,
               {tmc8670::kParameterGroups, tmc8670::kStorageCommands}),
      synchronisation_(objects(), reporter),
      hardware_uart_(axis_.stage().block()),
      mcu_uart_(objects(), kFirmwareCapacity, reporter),
      error_report_(objects(), tmc8670::kEmergencies) {
  set_boot_loader(mcu_uart_);
  slave_stack()->set_write_completion(&storage_);
  objects().on_read(0x100A, 0, dictionary::Entry::ReadHook::bind<&Tmc8670::show_version>(*this));
}

void Tmc8670::show_version(dictionary::Entry& entry) {
  entry.set_text(tmc8670::firmware_version(firmware()->image()));
}

void Tmc8670::connect_memory(canopen::NonVolatileMemory& memory) {
  memory_.connect(memory);
  restart_firmware(SimTime());
}

void Tmc8670::step_world(SimTime until) {
  while (next_period_ <= until) {
    const SimDuration period = axis_.pwm_period();
    axis_.step(next_period_);
    next_period_ += period;
  }
}

void Tmc8670::tick(SimTime now) {
  run_axis(now);
  hardware_uart_.serve(now);
  mcu_uart_.serve(now);
}

void Tmc8670::run_axis(SimTime now) {
  axis_.tick(now);
  report_errors(now);
  watch_junction(now);
}

void Tmc8670::at_sync0(SimTime now) {
  synchronisation_.count_pulse();
  run_axis(now);
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
  if (powered()) {
    hardware_uart_.serve(now);
  }
}

std::optional<std::uint32_t> Tmc8670::baud_rate(std::string_view interface) const {
  return interface == kSerialInterfaces[1] ? hardware_uart_.baud_rate()
                                           : tmc8670::McuUart::kBaudRate;
}

void Tmc8670::set_power(bool on, SimTime now) {
  supply_.switch_on(on, now);
  controller().hold_reset(on && !supply_.good());
  restart_chip(on && supply_.good(), now);
}

void Tmc8670::take_logic_supply(SimTime now) {
  const bool good = supply_.good();
  if (supply_.switched_on() && controller().held_in_reset() == good) {
    controller().hold_reset(!good);
    restart_chip(good, now);
  }
}

void Tmc8670::restart_chip(bool powered, SimTime now) {
  axis_.world().set_power(powered);
  EtherCatFirmware::set_power(powered, now);
  hardware_uart_.restart();
}

void Tmc8670::restart(SimTime now) {
  synchronisation_.forget_wishes();
  storage_.load(now);
  error_report_.restart();
  junction_hot_ = false;
  axis_.restart();
}

void Tmc8670::apply(SimTime now) {
  if (!stack().synchronous() && axis_.apply(now)) {
    report_errors(now);
  }
}

AlStatusCode Tmc8670::permit_state(AlState /*from*/, AlState to, SimTime now) {
  return to == AlState::operational ? synchronisation_.permit_operational(stack(), now)
                                    : AlStatusCode::no_error;
}

void Tmc8670::on_state(AlState from, AlState to, SimTime now) {
  if (to == AlState::init) {
    synchronisation_.forget_wishes();
  }
  EtherCatFirmware::on_state(from, to, now);
  synchronisation_.refresh(*slave_stack());
}

void Tmc8670::network_operational(bool operational, SimTime now) {
  axis_.set_network_operational(operational, now);
}

void Tmc8670::before_inputs(SimTime /*now*/) {
  axis_.refresh_objects();
  synchronisation_.refresh(*slave_stack());
}

void Tmc8670::report_errors(SimTime now) {
  error_report_.update(axis_.axis(), [&](const drive::AxisEmergency& row) {
    send_emergency(row.code, row.register_bits, {row.detail}, now);
  });
}

void Tmc8670::watch_junction(SimTime now) {
  const double celsius = axis_.world().junction_temperature();
  if (celsius > tmc8670::kJunctionMaximum) [[unlikely]] {
    reporter().report(now, kJunctionBroken,
                      {static_cast<int>(celsius), static_cast<int>(tmc8670::kJunctionMaximum)});
    restart_chip(false, now);
    return;
  }
  const bool hot = celsius > tmc8670::kJunctionOperating;
  if (hot && !junction_hot_) [[unlikely]] {
    namespace bits = drive::error_register;
    reporter().report(now, kJunctionHot,
                      {static_cast<int>(celsius), static_cast<int>(tmc8670::kJunctionOperating)});
    send_emergency(0x4210, bits::kOfTemperature, {1}, now);
  }
  junction_hot_ = hot;
}

}  // namespace stator::devices
