#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace stator::ethercat {

/// One sync manager: keeps bus and host from seeing half-written data in its area of the process
/// memory (ETG.1000.4 §6.3; TMC8461 datasheet "SyncManager registers").
///
/// Buffered mode has three buffers of `length` bytes one behind the other. Writer and reader each
/// hold one, the third is the newest complete one or free; only indices are exchanged. An exchange
/// happens when the writer has written the last byte and when the reader touches the first one.
/// Mailbox mode has one buffer and the flag "full": full, it is only read, empty, it is only
/// written. In both modes an access opens the buffer at its first byte and closes it at its last
/// one, in as many steps as it likes; bytes of a buffer that is not open are refused.
///
/// The class knows addresses and states only; bytes are moved by the controller.
class SyncManager {
 public:
  static constexpr std::size_t kRegisterLength = 8;

  /// Why a sync manager is, or is not, in charge of its area.
  enum class Condition : std::uint8_t {
    disabled,          ///< enable bit not set
    active,            ///< in charge
    deactivated,       ///< by the host (PDI control bit 0): nobody gets at the area
    watchdog_trigger,  ///< length 1: plain memory whose writing restarts the watchdog
    bad_mode,          ///< reserved mode or direction
    bad_area,          ///< length below 2, or the area does not lie within the process memory
  };

  /// Takes over start, length, control, activate and PDI control from the eight registers and
  /// starts with empty buffers. `memory_end` is the first address behind the process memory;
  /// `one_byte` says that a length of 1 is as good as any other, see
  /// SlaveControllerConfiguration::one_byte_sync_managers.
  void configure(std::span<const std::byte, kRegisterLength> registers, std::size_t memory_end,
                 bool one_byte = false);
  /// Takes over the bits that may change while active (watchdog trigger).
  void refresh_control(std::uint8_t control);

  [[nodiscard]] Condition condition() const { return condition_; }
  [[nodiscard]] bool active() const { return condition_ == Condition::active; }
  [[nodiscard]] bool buffered() const { return buffered_; }
  [[nodiscard]] bool bus_writes() const { return bus_writes_; }
  [[nodiscard]] bool triggers_watchdog() const { return watchdog_trigger_; }
  [[nodiscard]] std::uint16_t start() const { return start_; }
  [[nodiscard]] std::uint16_t length() const { return length_; }
  /// Bytes from start() on that nobody reaches but through this sync manager; 0 while disabled.
  [[nodiscard]] std::uint32_t guarded_length() const { return guarded_length_; }
  [[nodiscard]] bool guards(std::uint32_t address) const {
    return address - start_ < guarded_length_;
  }

  /// The writing side is about to write from byte `offset` of the area on. Opens the buffer at
  /// offset 0. False: refused.
  bool begin_write(std::uint32_t offset) {
    if (offset != 0) {
      return (status_ & kWriteOpen) != 0;
    }
    if ((status_ & kFull) != 0) {
      return false;
    }
    status_ = static_cast<std::uint8_t>((status_ & ~kReadInterrupt) | kWriteOpen);
    return true;
  }
  /// Memory address of the writer's buffer.
  [[nodiscard]] std::uint32_t write_base() const { return start_ + buffer_offset_[writing_]; }
  /// The writing side has written up to byte `end` (exclusive). True: the buffer is complete.
  bool end_write(std::uint32_t end) {
    if (end != length_) {
      return false;
    }
    const unsigned kept = status_ & kKeptOverWrite;
    if (buffered_) {
      std::swap(writing_, latest_);
      fresh_ = true;
      const auto last_buffer = static_cast<unsigned>(latest_) << kLastBufferShift;
      status_ = static_cast<std::uint8_t>(kept | kWriteInterrupt | last_buffer);
    } else {
      status_ = static_cast<std::uint8_t>(kept | kWriteInterrupt | kFull);
    }
    return true;
  }

  /// The reading side is about to read from byte `offset` of the area on. Opens the newest complete
  /// buffer at offset 0. False: refused.
  bool begin_read(std::uint32_t offset) {
    if (offset != 0) {
      return (status_ & kReadOpen) != 0;
    }
    if (!buffered_ && (status_ & kFull) == 0) {
      return false;
    }
    if (fresh_) {
      std::swap(latest_, reading_);
      fresh_ = false;
    }
    status_ = static_cast<std::uint8_t>((status_ & ~kWriteInterrupt) | kReadOpen);
    return true;
  }
  /// Memory address of the reader's buffer.
  [[nodiscard]] std::uint32_t read_base() const { return start_ + buffer_offset_[reading_]; }
  /// Memory address of the newest complete buffer, taken by the reader or not.
  [[nodiscard]] std::uint32_t newest_base() const {
    return start_ + buffer_offset_[fresh_ ? latest_ : reading_];
  }
  /// The reading side has read up to byte `end` (exclusive). True: the buffer was read completely.
  bool end_read(std::uint32_t end) {
    if (end != length_) {
      return false;
    }
    status_ = static_cast<std::uint8_t>((status_ & ~(kReadOpen | kFull)) | kReadInterrupt);
    return true;
  }

  /// The status register (+0x5).
  [[nodiscard]] std::uint8_t status() const { return status_; }
  [[nodiscard]] bool interrupts_host() const { return host_interrupt_bits_ != 0; }
  [[nodiscard]] bool interrupts_bus() const { return bus_interrupt_bits_ != 0; }
  /// The interrupt for the host: the bus has done its part and the host wants to know.
  [[nodiscard]] bool host_interrupt() const { return (status_ & host_interrupt_bits_) != 0; }
  /// The interrupt for the bus.
  [[nodiscard]] bool bus_interrupt() const { return (status_ & bus_interrupt_bits_) != 0; }

 private:
  static constexpr unsigned kWriteInterrupt = 0x01;
  static constexpr unsigned kReadInterrupt = 0x02;
  static constexpr unsigned kFull = 0x08;
  static constexpr unsigned kLastBufferShift = 4;
  static constexpr unsigned kNoBuffer = 0x30;
  static constexpr unsigned kReadOpen = 0x40;
  static constexpr unsigned kWriteOpen = 0x80;
  static constexpr unsigned kKeptOverWrite = kReadOpen | kReadInterrupt;

  std::uint16_t start_ = 0;
  std::uint16_t length_ = 0;
  std::uint32_t guarded_length_ = 0;
  std::array<std::uint32_t, 3> buffer_offset_{};  ///< of each buffer from start
  std::uint8_t status_ = kNoBuffer;
  std::uint8_t writing_ = 0;
  std::uint8_t latest_ = 1;
  std::uint8_t reading_ = 2;
  bool fresh_ = false;  ///< latest_ was written and not yet taken by the reader
  bool buffered_ = true;
  bool bus_writes_ = false;
  bool watchdog_trigger_ = false;
  std::uint8_t host_interrupt_bits_ = 0;
  std::uint8_t bus_interrupt_bits_ = 0;
  Condition condition_ = Condition::disabled;
};

}  // namespace stator::ethercat
