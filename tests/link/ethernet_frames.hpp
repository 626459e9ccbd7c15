#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stator::link {

/// An Ethernet frame of `length` bytes to an address that no interface has, with a pattern as
/// payload that `seed` varies.
inline std::vector<std::byte> make_frame(std::size_t length, unsigned seed = 0,
                                         std::uint16_t ether_type = 0x88A4) {
  std::vector<std::byte> frame(length);
  for (std::size_t i = 0; i < length; ++i) {
    frame[i] = static_cast<std::byte>(i * 7 + seed);
  }
  for (std::size_t i = 0; i < 6; ++i) {
    frame[i] = std::byte{0x04};
    frame[6 + i] = std::byte{0x02};
  }
  frame[12] = static_cast<std::byte>(ether_type >> 8);
  frame[13] = static_cast<std::byte>(ether_type & 0xFF);
  return frame;
}

}  // namespace stator::link
