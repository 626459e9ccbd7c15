#include "stator/devices/tmcc160/serial_interface.hpp"

#include <cstdint>

namespace stator::devices::tmcc160 {

namespace {

constexpr base::EventRule kVersionOnly{"tmcc160-serial-version-only", base::Severity::refusal,
                                       "serial: TMCL command {0} refused with status 6: the "
                                       "CANopen firmware answers the version (136) and starts the "
                                       "boot loader (242) here; use CAN"};

}  // namespace

SerialInterface::SerialInterface(std::size_t firmware_capacity, base::EventReporter reporter)
    : ModuleInterface({.line = "serial",
                       .version_text = "0160V300",
                       .boot_loader_text = "0160B100",
                       .version_number = 160 << 16 | 3 << 8 | 0,
                       .addressed = true},
                      {.size = static_cast<std::uint32_t>(firmware_capacity)}, reporter) {}

SerialInterface::Answer SerialInterface::execute(const tmcl::Request& request, base::SimTime now) {
  reporter().report(now, kVersionOnly, {int{request.command}});
  return {tmcl::Status::command_not_available};
}

}  // namespace stator::devices::tmcc160
