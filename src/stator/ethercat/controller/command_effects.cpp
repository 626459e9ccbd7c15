// What the commands to EEPROM (0x0502) and PHYs (0x0510) start, and why they are refused.

#include <algorithm>

#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

constexpr base::EventRule kSiiWriteEnable{
    "esc-sii-write-enable", base::Severity::refusal,
    "EEPROM write refused: bit 0 of register 0502h (write enable) was not set in the same frame; "
    "write 0201h as the command"};
constexpr base::EventRule kSiiCommand{
    "esc-sii-command", base::Severity::refusal,
    "EEPROM command {0} is none of 0 (idle), 1 (read), 2 (write), 4 (reload)"};
constexpr base::EventRule kSiiMissing{
    "esc-sii-missing", base::Severity::refusal,
    "EEPROM command {0} failed: no EEPROM is fitted; give the device an SII image"};
constexpr base::EventRule kSiiStillWriting{
    "esc-sii-still-writing", base::Severity::refusal,
    "EEPROM command {0} refused (0502h bit 13): the word written before is still on its way to the "
    "disk; try again"};
constexpr base::EventRule kSiiErrorPending{
    "esc-sii-error-pending", base::Severity::refusal,
    "EEPROM command {0} ignored: bit 13 of register 0502h still shows an error; write command 0 "
    "first"};
constexpr base::EventRule kMiiWriteEnable{
    "esc-mii-write-enable", base::Severity::refusal,
    "PHY write refused: bit 0 of register 0510h (write enable) was not set in the same frame; "
    "write 0201h as the command"};
constexpr base::EventRule kMiiCommand{
    "esc-mii-command", base::Severity::refusal,
    "MII management command {0} is none of 0 (idle), 1 (read), 2 (write)"};

}  // namespace

void SlaveController::start_sii_command() {
  const auto command = static_cast<unsigned>(registers()[kSiiControl + 1]) & 7U;
  frame_work_ |= FrameWork::kClearWriteEnables;
  switch (sii_.start_command(now_)) {
    case SiiInterface::CommandResult::started:
      next_deadline_ = std::min(next_deadline_, sii_.deadline());
      break;
    case SiiInterface::CommandResult::idle:
      break;
    case SiiInterface::CommandResult::invalid:
      reporter_.report(now_, kSiiCommand, {command});
      break;
    case SiiInterface::CommandResult::not_write_enabled:
      reporter_.report(now_, kSiiWriteEnable);
      break;
    case SiiInterface::CommandResult::error_pending:
      reporter_.report(now_, kSiiErrorPending, {command});
      break;
    case SiiInterface::CommandResult::still_writing:
      reporter_.report(now_, kSiiStillWriting, {command});
      break;
    case SiiInterface::CommandResult::no_acknowledge:
      reporter_.report(now_, kSiiMissing, {command});
      break;
  }
}

void SlaveController::start_mii_command() {
  const auto command = static_cast<unsigned>(registers()[kMiiControl + 1]) & 3U;
  frame_work_ |= FrameWork::kClearWriteEnables;
  switch (mii_.start_command(now_)) {
    case MiiManagement::CommandResult::started:
      next_deadline_ = std::min(next_deadline_, mii_.deadline());
      break;
    case MiiManagement::CommandResult::idle:
      break;
    case MiiManagement::CommandResult::invalid:
      reporter_.report(now_, kMiiCommand, {command});
      break;
    case MiiManagement::CommandResult::not_write_enabled:
      reporter_.report(now_, kMiiWriteEnable);
      break;
  }
}

}  // namespace stator::ethercat
