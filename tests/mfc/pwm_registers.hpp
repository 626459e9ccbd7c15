#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace stator::mfc::testing {

/// Fields of PWM_CFG.
struct PwmConfiguration {
  std::uint16_t maxcnt = 0;
  std::array<std::uint8_t, 4> modes{};
  std::uint8_t alignment = 0;
  std::uint8_t polarities = 0;  ///< bits 46:40
  std::uint8_t bbm_low = 0;
  std::uint8_t bbm_high = 0;

  [[nodiscard]] std::uint64_t value() const {
    std::uint64_t result = maxcnt | std::uint64_t{alignment} << 32 |
                           std::uint64_t{polarities} << 40 | std::uint64_t{bbm_low} << 48 |
                           std::uint64_t{bbm_high} << 56;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      result |= std::uint64_t{modes[i]} << (16 + 4 * i);
    }
    return result;
  }
};

}  // namespace stator::mfc::testing
