// The host side of a slave controller: whether it works at all, accesses, their supervision, and
// requests of the bus that nobody there answers.

#include <algorithm>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

constexpr base::EventRule kAlControlLocked{
    "esc-al-control-locked", base::Severity::refusal,
    "AL control write of {0:x4} refused: the host has not read the request before ({1:x4}) yet; "
    "wait for AL status, then write again"};
constexpr base::EventRule kHostClosed{
    "esc-al-control-host-closed", base::Severity::refusal,
    "AL control {0:x4} stays unanswered: the host interface is closed, because {1}; write a valid "
    "image to it and reload it (0400h to 0502h) or reset the device"};
constexpr base::EventRule kNoFirmware{
    "esc-al-control-no-firmware", base::Severity::refusal,
    "AL control {0:x4} stays unanswered: no firmware is attached, none has used the host interface "
    "yet; start the one that belongs to it (\"spi\" in the rack file names its socket), or let the "
    "state follow the master with \"device_emulation = true\""};
constexpr base::EventRule kHostInterface{
    "esc-pdi-type", base::Severity::warning,
    "host interface closed: the EEPROM names type {0:x2} in word 0, and only 05h (SPI slave) is "
    "built; no state is reached and no mailbox answers until a master writes an image with 05h "
    "and its checksum and reloads it (0400h to 0502h) or resets the device"};

constexpr unsigned kNoHostInterface = 0x00;  ///< on purpose, with device emulation

}  // namespace

/// Switches the host interface on if the EEPROM configures it, else off, and shows that in 0x014E.
void SlaveController::open_host_interface() {
  const auto type = std::to_integer<unsigned>(memory_[kPdiControl]);
  host_open_ = loaded_ && type == configuration_.host_interface;
  const bool wanted = type != kNoHostInterface || !register_bit(kEscConfiguration, 0);
  if (loaded_ && !host_open_ && wanted) {
    reporter_.report(now_, kHostInterface, {type});
  }
  if (has_feature(configuration_.features, ControllerFeature::pdi_information)) {
    // Configured and active, or configured for an interface that is not there.
    const unsigned configured = host_open_ ? 0x06U : 0x0AU;
    const unsigned state = loaded_ ? configured : 0x00U;
    memory_[kPdiInformation] =
        static_cast<std::byte>(state | (configuration_.acknowledge_by_write ? 1U : 0U));
  }
}

void SlaveController::set_host_polling(bool polling) {
  host_polling_ = polling;
  if (polling) {
    host_watchdog_.stop();
  } else {
    host_watchdog_.trigger(now_);
  }
  update_deadline();
  update_dl_status();
}

bool SlaveController::host_interrupt() const {
  return (al_event_request() & base::load_le<std::uint32_t>(memory_.data() + kAlEventMask)) != 0;
}

void SlaveController::read(std::uint16_t address, std::span<std::byte> out) {
  std::fill(out.begin(), out.end(), std::byte{0});
  host_seen_ = true;
  if (!host_open_) [[unlikely]] {
    return;
  }
  note_host_access();
  reset_sequence_.end_of_host_access();
  static_cast<void>(read_memory(Side::host, address, out));
}

void SlaveController::write(std::uint16_t address, std::span<const std::byte> data) {
  host_seen_ = true;
  if (!host_open_) [[unlikely]] {
    return;
  }
  note_host_access();
  static_cast<void>(write_memory(Side::host, address, data));
  reset_sequence_.end_of_host_access();
}

void SlaveController::note_host_access() {
  if (host_polling_) {
    return;
  }
  const bool revived = host_watchdog_.expired();
  host_watchdog_.trigger(now_);
  next_deadline_ = std::min(next_deadline_, host_watchdog_.deadline());
  if (revived) {
    update_dl_status();
  }
}

void SlaveController::count_host_error(std::uint8_t code) {
  count(kPdiErrors);
  if (register_map_[kPdiErrorCode].built) {
    memory_[kPdiErrorCode] = std::byte{code};
  }
}

void SlaveController::report_unanswered_al_control(std::uint16_t requested, bool locked) {
  if (!host_open_) {
    reporter_.report(now_, kHostClosed,
                     {requested, loaded_ ? base::StaticText("the EEPROM names another one than SPI")
                                         : base::StaticText("its EEPROM is not loaded")});
  } else if (!host_seen_) {
    reporter_.report(now_, kNoFirmware, {requested});
  } else if (locked) {
    reporter_.report(now_, kAlControlLocked,
                     {requested, base::load_le<std::uint16_t>(registers(), kAlControl)});
  }
}

}  // namespace stator::ethercat
