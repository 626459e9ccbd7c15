#pragma once

#include <cstdint>

#include "ethercat/test_bus.hpp"

namespace stator::ethercat::testing {

/// EEPROM content for a board that uses SYNC0, SYNC1 and both latch inputs.
struct DcBoard {
  std::uint8_t esc_configuration = 0x0C;  ///< 0x0141: SYNC unit and latch unit switched on
  std::uint8_t sync_latch = 0x66;         ///< 0x0151: push-pull high outputs, no AL events
  std::uint16_t pulse_length = 1000;      ///< 0x0982, units of 10 ns; 0: acknowledge mode
};

inline Bytes dc_sii(const DcBoard& board) {
  Bytes image = valid_sii();
  image[1] = std::byte{board.esc_configuration};
  image[3] = std::byte{board.sync_latch};
  base::store_le(image.data() + 4, board.pulse_length);
  image[14] = std::byte{sii_checksum(image)};
  return image;
}

/// A bus with one slave whose board uses the distributed clocks, and what tests of them need.
class DcBus : public TestBus {
 public:
  explicit DcBus(const DcBoard& board = {}, const SlaveControllerConfiguration& chip = {})
      : TestBus(1, chip) {
    slave().load_sii(dc_sii(board));
  }

  std::uint64_t get(std::uint16_t address, std::size_t length) {
    return number(read(0, address, length).data);
  }
  /// The working counter.
  unsigned set(std::uint16_t address, std::uint64_t value, std::size_t length) {
    return write(0, address, little_endian(value, length)).working_counter;
  }
  /// System time now, as the host would read it.
  std::uint64_t system_time() { return slave().system_time(now()); }
  /// Lets time pass up to that system time, at least.
  void wait_until(std::uint64_t time) {
    while (system_time() < time) {
      const auto rest = static_cast<std::int64_t>(time - system_time());
      wait(base::SimDuration(rest));
    }
  }
  /// As masters do: unit off, times, then on.
  void start_sync(std::uint64_t start, std::uint32_t cycle0, std::uint32_t cycle1 = 0,
                  unsigned activation = 3) {
    set(0x0981, 0, 1);
    set(0x0990, start, 8);
    set(0x09A0, cycle0, 4);
    set(0x09A4, cycle1, 4);
    set(0x0981, activation, 1);
  }
};

}  // namespace stator::ethercat::testing
