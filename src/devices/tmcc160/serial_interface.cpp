#include "devices/tmcc160/serial_interface.hpp"

#include <array>
#include <string_view>

#include "tmcl/command.hpp"

namespace stator::devices::tmcc160 {

namespace {

using base::EventRule;
using base::Severity;
using namespace base::literals;
using tmcl::Command;
using tmcl::Status;

constexpr std::uint8_t kModuleAddress = 1;
constexpr std::uint8_t kHostAddress = 2;
/// Module 160, firmware 3.00: as a number and as text, of firmware and boot loader.
constexpr std::int32_t kVersionNumber = 160 << 16 | 3 << 8 | 0;
constexpr std::string_view kVersionText = "0160V300";
constexpr std::string_view kBootLoaderText = "0160B100";
/// What command 242 must carry to start the boot loader.
constexpr std::uint8_t kBootType = 0x81;
constexpr std::uint8_t kBootMotor = 0x92;
constexpr std::uint32_t kBootValue = 0xA3B4C5D6;
/// Clients send the nine bytes of a telegram at once; the firmware looks for them every
/// millisecond.
constexpr base::SimDuration kGap = 100_ms;

constexpr EventRule kVersionOnly{"tmcc160-serial-version-only", Severity::refusal,
                                 "serial: TMCL command {0} refused with status 6: the CANopen "
                                 "firmware answers the version (136) "
                                 "and starts the boot loader (242) here; use CAN"};
constexpr EventRule kWrongChecksum{
    "tmcc160-serial-checksum", Severity::refusal,
    "serial: TMCL telegram refused with status 1: its last byte is {0:x2}, the sum of the others "
    "is {1:x2}; after a pause of 100 ms the next byte begins a new telegram"};
constexpr EventRule kWrongAddress{
    "tmcc160-serial-address", Severity::information,
    "serial: TMCL telegram for module {0} passed over in silence: this is module {1}"};
constexpr EventRule kNotStarted{
    "tmcc160-serial-no-firmware", Severity::refusal,
    "serial: the boot loader was told to start the firmware, but the image is incomplete: length "
    "and sum (command 208) must be those of what was written; load it again"};
constexpr EventRule kBootLoader{
    "tmcc160-serial-boot-loader", Severity::information,
    "serial: the boot loader was started; drive and CANopen node are at rest until it ends"};

}  // namespace

SerialInterface::SerialInterface(std::size_t firmware_capacity, base::EventReporter reporter)
    : reporter_(reporter),
      receiver_(kGap),
      boot_loader_({.size = static_cast<std::uint32_t>(firmware_capacity)}) {}

void SerialInterface::restart() {
  receiver_.reset();
  boot_loader_.enter();
  mode_ = Mode::firmware;
}

bool SerialInterface::take_boot_request() {
  if (mode_ != Mode::boot_requested) {
    return false;
  }
  mode_ = Mode::boot_loader;
  return true;
}

void SerialInterface::answer_all(base::SimTime now) {
  std::array<std::byte, 64> buffer{};
  while (const std::size_t length = port_->take(buffer)) {
    for (const std::byte byte : std::span(buffer).first(length)) {
      if (const auto telegram = receiver_.take(byte, now)) {
        answer(*telegram, now);
      }
    }
  }
}

// RS485 joins modules on one line: one that is not meant is silent.
void SerialInterface::answer(const tmcl::Telegram& telegram, base::SimTime now) {
  const tmcl::Request request = tmcl::decode_request(telegram);
  tmcl::Reply reply{.host_address = kHostAddress,
                    .module_address = kModuleAddress,
                    .status = Status::wrong_checksum,
                    .command = request.command,
                    .value = 0};
  if (!tmcl::has_right_checksum(telegram)) {
    reporter_.report(now, kWrongChecksum,
                     {std::to_integer<int>(telegram.back()), int{tmcl::checksum(telegram)}});
  } else if (request.address != kModuleAddress) {
    reporter_.report(now, kWrongAddress, {int{request.address}, int{kModuleAddress}});
    return;
  } else if (static_cast<Command>(request.command) == Command::get_firmware_version &&
             request.type == 0) {
    send_version_text();
    return;
  } else if (obey_silently(request, now)) {
    return;
  } else {
    const Answer answer = execute(request, now);
    reply.status = answer.status;
    reply.value = answer.value;
  }
  port_->send(tmcl::encode(reply));
}

// The only reply without checksum: host address and eight characters.
void SerialInterface::send_version_text() {
  const std::string_view text = in_boot_loader() ? kBootLoaderText : kVersionText;
  tmcl::Telegram telegram{};
  telegram[0] = std::byte{kHostAddress};
  for (std::size_t i = 0; i < text.size(); ++i) {
    telegram[i + 1] = static_cast<std::byte>(text[i]);
  }
  port_->send(telegram);
}

// Modules restart with both commands and answer neither.
bool SerialInterface::obey_silently(const tmcl::Request& request, base::SimTime now) {
  const auto command = static_cast<Command>(request.command);
  if (command == Command::boot && request.type == kBootType && request.motor == kBootMotor &&
      static_cast<std::uint32_t>(request.value) == kBootValue) {
    if (!in_boot_loader()) {
      reporter_.report(now, kBootLoader);
      mode_ = Mode::boot_requested;
    }
    return true;
  }
  if (command == Command::boot_start_application && in_boot_loader()) {
    if (!boot_loader_.erased() || boot_loader_.complete()) {
      mode_ = Mode::start_requested;
    } else {
      reporter_.report(now, kNotStarted);
    }
    return true;
  }
  return false;
}

SerialInterface::Answer SerialInterface::execute(const tmcl::Request& request, base::SimTime now) {
  if (in_boot_loader()) {
    return boot_loader_.execute(request);
  }
  if (static_cast<Command>(request.command) == Command::get_firmware_version) {
    return request.type == 1 ? Answer{Status::success, kVersionNumber} : Answer{Status::wrong_type};
  }
  reporter_.report(now, kVersionOnly, {int{request.command}});
  return {Status::command_not_available};
}

}  // namespace stator::devices::tmcc160
