#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "stator/base/event.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/ethercat/standard/process_data_interface.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

/// The eight registers of one sync manager as the host reads them (ETG.1000.4 §6.7.2).
struct SyncManagerSettings {
  std::uint16_t start = 0;
  std::uint16_t length = 0;
  std::uint8_t control = 0;
  std::uint8_t status = 0;
  std::uint8_t activate = 0;
  std::uint8_t host_control = 0;

  static constexpr std::uint8_t kModeMask = 0x03;
  static constexpr std::uint8_t kThreeBufferMode = 0x00;
  static constexpr std::uint8_t kMailboxMode = 0x02;
  static constexpr std::uint8_t kDirectionMask = 0x0C;
  static constexpr std::uint8_t kMasterReads = 0x00;
  static constexpr std::uint8_t kMasterWrites = 0x04;
  static constexpr std::uint8_t kHostInterrupt = 0x20;
  static constexpr std::uint8_t kWatchdogTrigger = 0x40;
  static constexpr std::uint8_t kStatusWritten = 0x01;  ///< buffer written, not yet read
  static constexpr std::uint8_t kStatusMailboxFull = 0x08;
  static constexpr std::uint8_t kActivateEnable = 0x01;
  static constexpr std::uint8_t kRepeatRequest = 0x02;  ///< in `activate`
  static constexpr std::uint8_t kHostDisable = 0x01;    ///< in `host_control`
  static constexpr std::uint8_t kRepeatAcknowledge = 0x02;

  [[nodiscard]] bool enabled() const { return (activate & kActivateEnable) != 0; }
  [[nodiscard]] bool interrupts_host() const { return (control & kHostInterrupt) != 0; }
  [[nodiscard]] std::uint8_t mode() const { return control & kModeMask; }
  /// First address behind the memory the channel takes; three-buffer mode takes its length thrice.
  [[nodiscard]] std::uint32_t end() const {
    const std::uint32_t buffers = mode() == kThreeBufferMode ? 3 : 1;
    return start + buffers * length;
  }
  [[nodiscard]] bool overlaps(const SyncManagerSettings& other) const {
    return enabled() && other.enabled() && start < other.end() && other.start < end();
  }
};

inline constexpr std::uint16_t kSyncManagerStatus = 5;  ///< offsets in a channel's registers
inline constexpr std::uint16_t kSyncManagerHostControl = 7;
inline constexpr unsigned kReceiveMailboxChannel = 0;
inline constexpr unsigned kTransmitMailboxChannel = 1;
inline constexpr unsigned kOutputChannel = 2;
inline constexpr unsigned kInputChannel = 3;

/// Address of register `offset` (0..7) of `channel`.
[[nodiscard]] constexpr std::uint16_t sync_manager_register(unsigned channel,
                                                            std::uint16_t offset) {
  return static_cast<std::uint16_t>(register_address::kSyncManagers + channel * 8 + offset);
}

using SyncManagerBank = std::array<SyncManagerSettings, 4>;

/// The settings of channels 0 to 3. Reads those of all 16 channels, because only that acknowledges
/// the activation-change event whichever channel it came from.
[[nodiscard]] SyncManagerBank read_sync_managers(ProcessDataInterface& interface);

/// What the slave needs of one channel.
struct SyncManagerRequirement {
  unsigned channel = 0;
  std::uint8_t mode = SyncManagerSettings::kMailboxMode;
  std::uint8_t direction = SyncManagerSettings::kMasterWrites;
  std::size_t min_length = 0;
  std::size_t max_length = 0;  ///< 0: the channel must not be used
  std::uint16_t memory_end = 0;
};

/// Why a channel's settings cannot work.
struct SyncManagerFault {
  const base::EventRule* rule = nullptr;
  std::array<base::EventArgument, 6> arguments{};
};

/// Checks one channel of `bank`; empty if it is as required. `state` and `code` only go into the
/// event's words.
[[nodiscard]] std::optional<SyncManagerFault> check_sync_manager(
    const SyncManagerBank& bank, const SyncManagerRequirement& requirement, AlState state,
    AlStatusCode code);

// Arguments: {0} state, {1} AL status code, {2} channel, then what the rule adds.
namespace rules {
using base::EventRule;
using base::Severity;

inline constexpr EventRule kSyncManagerDisabled{
    "al-sm-disabled", Severity::refusal,
    "{0} impossible, AL status {1:x4}: SM{2} is not enabled; write its length and control byte and "
    "set bit 0 of its activate register first"};
inline constexpr EventRule kSyncManagerMode{
    "al-sm-mode", Severity::refusal,
    "{0} impossible, AL status {1:x4}: SM{2} control byte is {3:x2}, needs {4:x2} in bits 3..0 "
    "(buffer mode and direction); take it from the SII"};
inline constexpr EventRule kSyncManagerLength{
    "al-sm-length", Severity::refusal,
    "{0} impossible, AL status {1:x4}: SM{2} length {3}, mapping needs {4}; set the length to that "
    "or change the PDO mapping in Pre-Operational"};
inline constexpr EventRule kSyncManagerMailboxLength{
    "al-sm-mailbox-length", Severity::refusal,
    "{0} impossible, AL status {1:x4}: SM{2} length {3}, the mailbox takes {4} to {5} bytes; take "
    "the length from the SII"};
inline constexpr EventRule kSyncManagerUnmapped{
    "al-sm-unmapped", Severity::refusal,
    "{0} impossible, AL status {1:x4}: SM{2} is enabled with length {3}, but no process data are "
    "mapped there; disable it or assign a PDO in Pre-Operational"};
inline constexpr EventRule kSyncManagerArea{
    "al-sm-area", Severity::refusal,
    "{0} impossible, AL status {1:x4}: SM{2} takes {3:x4} to {4:x4}, which is not inside the "
    "process memory from 1000h to {5:x4}; take the start address from the SII"};
inline constexpr EventRule kSyncManagerOverlap{
    "al-sm-overlap", Severity::refusal,
    "{0} impossible, AL status {1:x4}: SM{2} from {3:x4} overlaps SM{4} from {5:x4}; take the "
    "start addresses from the SII (three-buffer mode takes three times the length)"};
inline constexpr EventRule kSyncManagerChanged{
    "al-sm-changed", Severity::refusal,
    "{0} impossible, AL status {1:x4}: SM{2} was changed to start {3:x4}, length {4} while in use; "
    "go to a lower state before changing it"};
}  // namespace rules

}  // namespace stator::ethercat
