#include "stator/devices/tmc8670/mcu_uart.hpp"

#include <array>

namespace stator::devices::tmc8670 {

namespace {

using tmcl::Status;

constexpr auto kParameters = std::to_array<product::ReadableParameter>({
    {0, "target position", 0x607A},
    {1, "actual position", 0x6064},
    {2, "target speed", 0x60FF},
    {3, "actual speed", 0x606C},
    {4, "maximum ramp velocity", 0x6081},
    {6, "maximum torque", 0x6072},
    {8, "position reached", 0x6041, 0, 10, 1},
    {9, "home switch", 0x60FD, 0, 2, 1},
    {10, "right limit switch", 0x60FD, 0, 1, 1},
    {11, "left limit switch", 0x60FD, 0, 0, 1},
    {12, "ramp acceleration", 0x6083},
    {13, "ramp velocity", 0x606B},
    {150, "actual current", 0x6078},
    {151, "supply voltage", 0x6079},
    {155, "target current", 0x6071},
    {156, "statusword", 0x6041},
    {172, "torque P", 0x2030, 3},
    {173, "torque I", 0x2030, 4},
    {174, "velocity P", 0x2030, 5},
    {175, "velocity I", 0x2030, 6},
    {177, "position P", 0x2030, 7},
    {208, "position error", 0x60F4},
    {209, "encoder position", 0x2070, 12},
    {250, "motor type", 0x2000, 1},
    {251, "encoder resolution", 0x2010, 1},
    {253, "motor pole pairs", 0x2000, 2},
});

}  // namespace

std::span<const product::ReadableParameter> readable_parameters() {
  return kParameters;
}

McuUart::McuUart(const dictionary::Dictionary& dictionary, std::size_t firmware_capacity,
                 base::EventReporter reporter)
    : TmclMonitor(dictionary, kParameters, std::array<IndexOffsets, 1>{},
                  {.line = "MCU UART",
                   .version_text = "8670V100",
                   .boot_loader_text = "8670B100",
                   .version_number = 8670 << 16 | 1 << 8 | 0},
                  {.size = static_cast<std::uint32_t>(firmware_capacity)}, reporter),
      digital_inputs_(dictionary.variable<std::uint32_t>(0x60FD)),
      supply_voltage_(dictionary.variable<std::uint32_t>(0x6079)) {}

McuUart::Answer McuUart::get_input(const tmcl::Request& request) const {
  constexpr std::uint8_t kDigitalInputs = 0;
  constexpr std::uint8_t kAnalogInputs = 1;
  constexpr std::uint8_t kSwitches = 3;
  switch (request.motor) {
    case kDigitalInputs:
      if (request.type >= kSwitches) {
        return {Status::wrong_type};
      }
      return {Status::success, (digital_inputs_.get() >> request.type & 1U) != 0 ? 1 : 0};
    case kAnalogInputs:
      if (request.type != 0) {
        return {Status::wrong_type};
      }
      return {Status::success, static_cast<std::int32_t>(supply_voltage_.get())};
    default:
      return {Status::invalid_value};
  }
}

}  // namespace stator::devices::tmc8670
