#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "stator/base/sim_time.hpp"
#include "stator/can/frame.hpp"
#include "stator/link/can/can_error_frame.hpp"

namespace stator::link {

/// One datagram of python-can's interface "udp_multicast": a MessagePack map with the fields of a
/// can.Message. What a receiver there does not understand ends its receiving thread, so exactly the
/// fields it sends itself are sent: data as "bin", a length that is the data's, no others.
struct MulticastMessage {
  static constexpr std::size_t kMaximumSize = 192;

  std::array<std::byte, kMaximumSize> bytes{};
  std::size_t size = 0;

  [[nodiscard]] std::span<const std::byte> content() const { return std::span(bytes).first(size); }
};

[[nodiscard]] MulticastMessage encode_multicast(const can::Frame& frame, base::SimTime time);
[[nodiscard]] MulticastMessage encode_multicast(const ErrorFrame& error, base::SimTime time);

enum class MulticastContent : std::uint8_t {
  frame,
  error_frame,    ///< well-formed; nothing for the bus
  not_classical,  ///< CAN FD
  malformed,
};
struct DecodedMulticast {
  MulticastContent content = MulticastContent::malformed;
  can::Frame frame;
};

/// Reads one datagram. Fields may come in any order and be absent, with python-can's defaults (an
/// identifier is extended unless told otherwise); unknown fields are ignored.
[[nodiscard]] DecodedMulticast decode_multicast(std::span<const std::byte> datagram);

}  // namespace stator::link
