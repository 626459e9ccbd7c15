#pragma once

#include <cstdint>

namespace stator::tmcl {

/// @name Banks of SIO and GIO (TMCM-142 manual, 6.7.14 and 6.7.15)
/// @{
inline constexpr std::uint8_t kDigitalInputBank = 0;
inline constexpr std::uint8_t kAnalogInputBank = 1;
inline constexpr std::uint8_t kOutputBank = 2;
/// @}

/// Instead of a port: all of them, of outputs and digital inputs.
inline constexpr std::uint8_t kAllPorts = 255;
/// Instead of the bits of all outputs: the accumulator.
inline constexpr std::int32_t kFromAccumulator = -1;
/// The most that all outputs are set to.
inline constexpr std::int32_t kOutputBits = 0xFF;

/// Whether `ports`, a bit mask, has `port`.
[[nodiscard]] constexpr bool has_port(std::uint32_t ports, std::uint8_t port) {
  return port < 32 && (ports >> port & 1U) != 0;
}

}  // namespace stator::tmcl
