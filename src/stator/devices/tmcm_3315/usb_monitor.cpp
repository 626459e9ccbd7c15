#include "stator/devices/tmcm_3315/usb_monitor.hpp"

#include <array>
#include <string>

namespace stator::devices::tmcm_3315 {

namespace {

using tmcl::Status;

/// Module 3315 and its firmware.
tmcl::ModuleIdentity identity(FirmwareVersion firmware) {
  const int minor = static_cast<int>(firmware);
  return {.line = "USB",
          .version_text = "3315V10" + std::to_string(minor),
          .boot_loader_text = "3315B100",
          .version_number = 3315 << 16 | 1 << 8 | minor};
}

constexpr std::array<UsbMonitor::IndexOffsets, kAxisCount> kAxes{
    {{0, 0},
     {kManufacturerAxisOffset, kProfileAxisOffset},
     {2 * kManufacturerAxisOffset, 2 * kProfileAxisOffset}}};

constexpr auto kParameters = std::to_array<product::ReadableParameter>({
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

}  // namespace

std::span<const product::ReadableParameter> readable_parameters() {
  return kParameters;
}

UsbMonitor::UsbMonitor(const dictionary::Dictionary& dictionary, const ModuleIo& io,
                       FirmwareVersion firmware, std::size_t firmware_capacity,
                       base::EventReporter reporter)
    : TmclMonitor(dictionary, kParameters, kAxes, identity(firmware),
                  {.size = static_cast<std::uint32_t>(firmware_capacity)}, reporter),
      io_(io) {}

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
