#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "stator/base/sim_time.hpp"

namespace stator::ethercat {

/// What is behind an SPI slave port: bytes at 16-bit addresses. One call is one access; whatever an
/// access causes, it causes once, however many bytes it has.
class SpiSlaveMemory {
 public:
  SpiSlaveMemory() = default;
  SpiSlaveMemory(const SpiSlaveMemory&) = delete;
  SpiSlaveMemory& operator=(const SpiSlaveMemory&) = delete;
  virtual ~SpiSlaveMemory() = default;

  /// False: the interface is not in operation; it answers 0 and does nothing.
  [[nodiscard]] virtual bool operational() const = 0;
  /// The bytes that answer the header, first one first.
  [[nodiscard]] virtual std::array<std::byte, 3> header_reply() const = 0;
  /// The host looked at the header's answer only (NOP).
  virtual void touch() = 0;
  virtual void read(std::uint16_t address, std::span<std::byte> out) = 0;
  virtual void write(std::uint16_t address, std::span<const std::byte> data) = 0;
  /// An access broke a rule; `code` is as register 0x030E shows it.
  virtual void count_error(std::uint8_t code) = 0;
};

/// What bytes alone do not tell of a transfer.
struct SpiTiming {
  /// From the last clock of the header to the first one of the data; nothing: long enough.
  std::optional<base::SimDuration> read_pause{};
  /// Clock cycles after the last whole byte, 0..7, before chip select ends.
  unsigned surplus_clocks = 0;
};

/// Bits of register 0x030E (TMC8461 datasheet L3990-L4015).
namespace spi_error {
inline constexpr std::uint8_t kClocks = 0x07;              ///< clock cycles modulo 8
inline constexpr std::uint8_t kBusy = 0x08;                ///< data asked for too early
inline constexpr std::uint8_t kTerminationMissing = 0x10;  ///< last byte was not FFh
inline constexpr std::uint8_t kContinued = 0x20;           ///< bytes after the one with FFh
inline constexpr unsigned kCommandShift = 6;               ///< bits 2 and 1 of the command
}  // namespace spi_error

/// The SPI slave protocol of the TMC8461, the same at the process data interface and at MFC CTRL
/// (datasheet L975-L1202): a header of two or more bytes with address and command, then data. Works
/// on whole bytes, most significant bit first; what the wire's mode and polarity are is nobody's
/// business here.
///
/// A datagram may come in pieces while chip select lasts. Each piece of its data is one access of
/// the memory.
class SpiSlavePort {
 public:
  /// A read without wait state needs this pause before its data (L1054).
  static constexpr base::SimDuration kReadPause{240};
  /// What is sent where the document leaves it undefined.
  static constexpr std::byte kUndefined{0};

  explicit SpiSlavePort(SpiSlaveMemory& memory) : memory_(memory) {}

  /// Chip select begins. In the middle of a datagram that datagram is forgotten.
  void select();
  /// Bytes pass in both directions; `miso` is as long as `mosi`. Without chip select nothing
  /// listens, and the answer is undefined.
  void transfer(std::span<const std::byte> mosi, std::span<std::byte> miso,
                std::optional<base::SimDuration> read_pause = {});
  /// Chip select ends; what was wrong with the datagram is counted now.
  void deselect(unsigned surplus_clocks = 0);
  [[nodiscard]] bool selected() const { return phase_ != Phase::idle; }

  /// A whole datagram.
  void exchange(std::span<const std::byte> mosi, std::span<std::byte> miso,
                const SpiTiming& timing = {});

  /// The device was reset: chip select has to come again.
  void reset() { phase_ = Phase::idle; }

 private:
  /// What the next byte is.
  enum class Phase : std::uint8_t {
    idle,
    first,
    second,
    extension,  ///< third byte, or a repetition of it
    wait_state,
    read,
    write,
    nothing,  ///< no data belong to the command
    closed,   ///< the interface does not operate
  };
  struct Command {
    static constexpr unsigned kNop = 0;
    static constexpr unsigned kRead = 2;
    static constexpr unsigned kReadWithWaitState = 3;
    static constexpr unsigned kWrite = 4;
    static constexpr unsigned kAddressExtension = 6;
  };

  [[nodiscard]] std::byte take_header(std::byte byte);
  void take_command(unsigned command);
  void read(std::span<const std::byte> mosi, std::span<std::byte> miso,
            std::optional<base::SimDuration> pause);
  void read_memory(std::span<std::byte> out);
  void write(std::span<const std::byte> data);

  SpiSlaveMemory& memory_;
  std::array<std::byte, 3> header_reply_{};
  Phase phase_ = Phase::idle;
  std::uint16_t address_ = 0;
  std::uint8_t command_ = 0;
  std::uint8_t error_ = 0;         ///< as in 0x030E, without the command
  bool extended_ = false;          ///< the third byte has come once
  bool data_started_ = false;      ///< a byte of read data has passed
  bool terminated_ = false;        ///< the byte with FFh has passed
  bool reserved_command_ = false;  ///< 1, 5 or 7
};

}  // namespace stator::ethercat
