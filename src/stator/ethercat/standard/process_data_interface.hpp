#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace stator::ethercat {

/// The host side (PDI) of an EtherCAT slave controller: two functions and an event word, as real
/// controllers offer it over SPI or a parallel bus. Slave software knows the controller only
/// through this interface, so the same software would run on a board.
class ProcessDataInterface {
 public:
  ProcessDataInterface() = default;
  ProcessDataInterface(const ProcessDataInterface&) = delete;
  ProcessDataInterface& operator=(const ProcessDataInterface&) = delete;
  virtual ~ProcessDataInterface() = default;

  /// Reads `out.size()` bytes from `address` with the host's rights and all side effects a host
  /// read has (events acknowledged, sync manager buffers taken and released). Bytes the host may
  /// not read come back as 0.
  virtual void read(std::uint16_t address, std::span<std::byte> out) = 0;

  /// Writes `data` to `address` with the host's rights and side effects. Bytes the host may not
  /// write are ignored.
  virtual void write(std::uint16_t address, std::span<const std::byte> data) = 0;

  /// The AL event request register 0x0220, without side effects: what the interrupt line tells.
  [[nodiscard]] virtual std::uint32_t al_event_request() const = 0;

  /// False while the controller is dead to its host, because its EEPROM is not loaded or names
  /// another interface: reads give 0, writes do nothing, and there are no events.
  [[nodiscard]] virtual bool answers() const { return true; }
};

/// Bits of the AL event request register 0x0220 (ETG.1000.4 §6.1.7; same in the TMC8461 datasheet).
namespace al_event {
inline constexpr std::uint32_t kAlControl = 1U << 0;              ///< the master requests a state
inline constexpr std::uint32_t kDcLatch = 1U << 1;                ///< a latch unit has an edge
inline constexpr std::uint32_t kDcSync0 = 1U << 2;                ///< SYNC0
inline constexpr std::uint32_t kDcSync1 = 1U << 3;                ///< SYNC1
inline constexpr std::uint32_t kSyncManagerActivation = 1U << 4;  ///< a sync manager was switched
inline constexpr std::uint32_t kEepromEmulation = 1U << 5;        ///< the EEPROM is asked for
inline constexpr std::uint32_t kProcessDataWatchdog =
    1U << 6;  ///< it has expired, or outputs come again
/// Interrupt of sync manager `channel` (0..15).
constexpr std::uint32_t sync_manager(unsigned channel) {
  return 1U << (8 + channel);
}
}  // namespace al_event

}  // namespace stator::ethercat
