#pragma once

#include <cstdint>

#include "stator/can/frame.hpp"

namespace stator::can {

/// Recessive bits that follow each frame before the next may begin (ISO 11898-1 §10.4.6).
inline constexpr unsigned kIntermissionBits = 3;
/// An error flag of six bits and its delimiter of eight (§10.4.4), when all see the error at once.
inline constexpr unsigned kErrorFrameBits = 6 + 8;
/// What an error-passive transmitter waits in addition to the intermission (§10.4.6.4).
inline constexpr unsigned kSuspendTransmissionBits = 8;
/// CRC delimiter, ACK slot and delimiter, end of frame: the part that is never stuffed.
inline constexpr unsigned kTailBits = 1 + 2 + 7;

/// The CRC-15 register after one more bit: generator polynomial 4599h, initially 0 (§10.4.2.6).
[[nodiscard]] constexpr std::uint16_t crc15_next(std::uint16_t crc, unsigned bit) {
  const unsigned feedback = bit ^ (crc >> 14U & 1U);
  return static_cast<std::uint16_t>((static_cast<unsigned>(crc) << 1U ^ feedback * 0x4599U) &
                                    0x7FFFU);
}

/// What stands on the wire of a frame from its start to the end of its CRC sequence.
struct FrameBits {
  unsigned unstuffed = 0;  ///< bits from SOF to the last bit of the CRC sequence
  unsigned stuff = 0;      ///< stuff bits among them: one after each five equal bits
  std::uint16_t crc = 0;   ///< sequence of those bits before stuffing
};
[[nodiscard]] FrameBits frame_bits(const Frame& frame);

/// The frame's length on the wire in bit times, from start of frame to end of frame with stuff
/// bits and without the intermission.
[[nodiscard]] unsigned frame_length_in_bits(const Frame& frame);

}  // namespace stator::can
