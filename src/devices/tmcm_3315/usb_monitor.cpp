#include "devices/tmcm_3315/usb_monitor.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "tmcl/command.hpp"

namespace stator::devices::tmcm_3315 {

namespace {

using base::EventArgument;
using base::EventRule;
using base::Severity;
using tmcl::Command;
using tmcl::Status;

/// Module 3315 and its firmware.
tmcl::ModuleIdentity identity(FirmwareVersion firmware) {
  const int minor = static_cast<int>(firmware);
  return {.line = "USB",
          .version_text = "3315V10" + std::to_string(minor),
          .boot_loader_text = "3315B100",
          .version_number = 3315 << 16 | 1 << 8 | minor};
}

constexpr EventRule kReadsOnly{
    "tmcm3315-usb-reads-only", Severity::refusal,
    "USB: {0} (TMCL command {1}) refused with status 6: this interface reads values and moves or "
    "changes nothing; use EtherCAT"};
constexpr EventRule kUnknownCommand{
    "tmcm3315-usb-unknown-command", Severity::refusal,
    "USB: TMCL command {0} refused with status 2: this interface knows GAP (6), GGP (10), GIO (15) "
    "and the firmware version (136)"};
constexpr auto kParameters = std::to_array<ReadableParameter>({
    {0, "target position", 0x607A},
    {1, "actual position", 0x6064},
    {2, "target speed", 0x60FF},
    {3, "actual speed", 0x606C},
    {4, "maximum positioning speed", 0x6081},
    {5, "maximum acceleration", 0x6083},
    {6, "maximum current", 0x2003},
    {7, "standby current", 0x2004},
    {8, "position reached", 0x6041, 0, 10, 1},
    {9, "home switch", 0x60FD, 0, 2, 1},
    {10, "right limit switch", 0x60FD, 0, 1, 1},
    {11, "left limit switch", 0x60FD, 0, 0, 1},
    {12, "right limit switch disable", 0x2005, 0, 1, 1},
    {13, "left limit switch disable", 0x2005, 0, 0, 1},
    {15, "acceleration A1", 0x2011},
    {16, "velocity V1", 0x2012},
    {17, "maximum deceleration", 0x6084},
    {18, "deceleration D1", 0x2013},
    {19, "start velocity", 0x2010},
    {140, "microstep resolution", 0x2000},
    {162, "chopper blank time", 0x2092},
    {163, "chopper mode", 0x2093},
    {164, "chopper hysteresis decrement", 0x2094},
    {165, "chopper hysteresis end", 0x2095},
    {166, "chopper hysteresis start", 0x2096},
    {167, "chopper off time", 0x2097},
    {168, "smart energy current minimum", 0x2098},
    {169, "smart energy current down step", 0x2099},
    {170, "smart energy hysteresis", 0x209A},
    {171, "smart energy current up step", 0x209B},
    {172, "smart energy hysteresis start", 0x209C},
    {173, "StallGuard2 filter enable", 0x209D},
    {174, "StallGuard2 threshold", 0x209E},
    {177, "short protection disable", 0x20A1},
    {181, "stop on stall velocity", 0x20A4},
    {182, "smart energy threshold speed", 0x20A5},
    {186, "PWM threshold speed", 0x20B0},
    {187, "PWM gradient", 0x20B1},
    {188, "PWM amplitude", 0x20B2},
    {200, "boost current", 0x204E},
    {202, "motor full steps", 0x2001},
    {206, "load value", 0x2101},
    {208, "driver error flags", 0x2102},
    {209, "encoder position", 0x6063},
    {210, "encoder resolution", 0x608F, 1},
    {212, "maximum encoder deviation", 0x6065},
    {214, "standby delay", 0x2089},
});

/// Commands that exist on modules of this family and would move or change something.
constexpr bool moves_or_changes(Command command) {
  switch (command) {
    case Command::rotate_right:
    case Command::rotate_left:
    case Command::motor_stop:
    case Command::move_to_position:
    case Command::set_axis_parameter:
    case Command::store_axis_parameter:
    case Command::restore_axis_parameter:
    case Command::set_global_parameter:
    case Command::store_global_parameter:
    case Command::restore_global_parameter:
    case Command::reference_search:
    case Command::set_output:
    case Command::set_coordinate:
    case Command::get_coordinate:
    case Command::capture_coordinate:
    case Command::accumulator_to_coordinate:
    case Command::stop_application:
    case Command::run_application:
    case Command::step_application:
    case Command::reset_application:
    case Command::start_download:
    case Command::quit_download:
    case Command::restore_factory_settings:
    case Command::software_reset:
      return true;
    default:
      return false;
  }
}

}  // namespace

std::span<const ReadableParameter> readable_parameters() {
  return kParameters;
}

UsbMonitor::UsbMonitor(const dictionary::Dictionary& dictionary, const ModuleIo& io,
                       FirmwareVersion firmware, std::size_t firmware_capacity,
                       base::EventReporter reporter)
    : ModuleInterface(identity(firmware), {.size = static_cast<std::uint32_t>(firmware_capacity)},
                      reporter),
      io_(io) {
  for (std::uint8_t axis = 0; axis < kAxisCount; ++axis) {
    for (const ReadableParameter& parameter : kParameters) {
      const unsigned offset =
          axis * (parameter.index < 0x6000 ? kManufacturerAxisOffset : kProfileAxisOffset);
      const dictionary::Entry* source =
          dictionary.find(static_cast<std::uint16_t>(parameter.index + offset), parameter.subindex);
      if (source == nullptr) {
        throw std::logic_error("TMCL axis parameter " + std::to_string(parameter.number) +
                               " shows an object that does not exist");
      }
      sources_[axis].push_back(source);
    }
  }
}

UsbMonitor::Answer UsbMonitor::execute(const tmcl::Request& request, base::SimTime now) {
  const auto command = static_cast<Command>(request.command);
  switch (command) {
    case Command::get_axis_parameter:
      return get_axis_parameter(request);
    case Command::get_global_parameter:
      return get_global_parameter(request, now);
    case Command::get_input:
      return get_input(request);
    default:
      break;
  }
  if (moves_or_changes(command)) {
    reporter().report(
        now, kReadsOnly,
        {EventArgument(tmcl::name_of(request.command)), EventArgument(int{request.command})});
    return {Status::command_not_available};
  }
  reporter().report(now, kUnknownCommand, {EventArgument(int{request.command})});
  return {Status::invalid_command};
}

UsbMonitor::Answer UsbMonitor::get_axis_parameter(const tmcl::Request& request) const {
  const auto parameter = std::ranges::find(kParameters, request.type, &ReadableParameter::number);
  if (parameter == kParameters.end()) {
    return {Status::wrong_type};
  }
  if (request.motor >= kAxisCount) {
    return {Status::invalid_value};
  }
  const auto position = static_cast<std::size_t>(parameter - kParameters.begin());
  const std::uint64_t value = sources_[request.motor][position]->value() >> parameter->first_bit;
  const std::uint64_t mask = (std::uint64_t{1} << parameter->bits) - 1;
  return {Status::success, static_cast<std::int32_t>(value & mask)};
}

UsbMonitor::Answer UsbMonitor::get_global_parameter(const tmcl::Request& request,
                                                    base::SimTime now) {
  constexpr std::uint8_t kOwnSerialAddress = 66;
  constexpr std::uint8_t kSerialHostAddress = 76;
  constexpr std::uint8_t kTickTimer = 132;
  if (request.motor != 0) {
    return {Status::invalid_value};
  }
  switch (request.type) {
    case kOwnSerialAddress:
      return {Status::success, kModuleAddress};
    case kSerialHostAddress:
      return {Status::success, kHostAddress};
    case kTickTimer:
      return {Status::success, static_cast<std::int32_t>(now.nanoseconds() / 1'000'000)};
    default:
      return {Status::wrong_type};
  }
}

UsbMonitor::Answer UsbMonitor::get_input(const tmcl::Request& request) const {
  constexpr std::uint8_t kDigitalInputs = 0;
  constexpr std::uint8_t kAnalogInputs = 1;
  constexpr std::uint8_t kOutputs = 2;
  const std::size_t port = request.type;
  if (port >= ModuleIo::kChannels) {
    return {Status::wrong_type};
  }
  switch (request.motor) {
    case kDigitalInputs:
      return {Status::success, io_.level(port) ? 1 : 0};
    case kAnalogInputs:
      return {Status::success, io_.counts(port)};
    case kOutputs:
      return {Status::success, io_.output_duty(port) > 0.0 ? 1 : 0};
    default:
      return {Status::invalid_value};
  }
}

}  // namespace stator::devices::tmcm_3315
