#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/ethercat/registers/time_stamp.hpp"

namespace stator::ethercat {

/// The latch units of the distributed clocks: keep the system time of edges at two inputs
/// (registers 0x09A8..0x09CF; TMC8461 and TMC8670 datasheets "DC latch in unit"). Works on the
/// controller's register memory; which side controls a unit stands in 0x0980.
class LatchUnit {
 public:
  static constexpr std::size_t kInputs = 2;

  explicit LatchUnit(std::span<std::byte, kRegisterSpace> registers) : registers_(registers) {}

  /// As after power-on: no times, no events; the inputs keep their levels.
  void reset();

  /// The level at an input is `level` from system time `now` on.
  void set_input(std::size_t input, bool level, std::uint64_t now);

  /// System time of the last rising edge at an input, as 0x09B0 and 0x09C0 show it.
  [[nodiscard]] std::uint64_t rising_edge(std::size_t input) const {
    return inputs_[input].times[0];
  }

  /// 0x09A8 or 0x09A9 has been written: continuous mode keeps no event.
  void take_control();

  /// Brings status and the times that `side` is going to read up to date.
  void show(AccessSide side, std::size_t address, std::size_t length);
  /// `side` has read, or has acknowledged by writing, `length` bytes from `address` on.
  void acknowledge(AccessSide side, std::size_t address, std::size_t length);

  /// True if an edge waits to be read by `side`: bit 0 of the ECAT event request, bit 1 of the AL
  /// event request.
  [[nodiscard]] bool event(AccessSide side) const;

 private:
  static constexpr std::size_t kEdges = 2;  // rising, falling
  struct Input {
    bool level = false;
    bool pending = false;       ///< an edge nobody has read yet
    std::uint8_t captured = 0;  ///< bits 0 and 1 of the status: single-event mode only
    std::array<std::uint64_t, kEdges> times{};
  };

  [[nodiscard]] AccessSide controlled_by(std::size_t input) const;

  std::span<std::byte, kRegisterSpace> registers_;
  std::array<Input, kInputs> inputs_{};
  /// By input, then rising before falling.
  std::array<TimeStamp<std::uint64_t>, kInputs * kEdges> stamps_{
      TimeStamp<std::uint64_t>{register_address::kLatch0PositiveEdge},
      TimeStamp<std::uint64_t>{register_address::kLatch0NegativeEdge},
      TimeStamp<std::uint64_t>{register_address::kLatch1PositiveEdge},
      TimeStamp<std::uint64_t>{register_address::kLatch1NegativeEdge}};
};

}  // namespace stator::ethercat
