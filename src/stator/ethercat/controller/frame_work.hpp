#pragma once

#include <cstdint>

namespace stator::ethercat {

/// What a slave controller has to do before or after the datagrams of a frame; 0 nearly always.
struct FrameWork {
  static constexpr std::uint8_t kClearWriteEnables = 1U << 0;  ///< SII, MII: at the next frame
  static constexpr std::uint8_t kLockRegisters = 1U << 1;      ///< 0x0020, 0x0030: at the end
  static constexpr std::uint8_t kLatchReceiveTimes = 1U << 2;
  static constexpr std::uint8_t kCompareSystemTime = 1U << 3;
  static constexpr std::uint8_t kApplyLoopControl = 1U << 4;
  static constexpr std::uint8_t kResetKey = 1U << 5;
  static constexpr std::uint8_t kTakeStartTime = 1U << 6;
};

}  // namespace stator::ethercat
