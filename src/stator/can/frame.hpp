#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

namespace stator::can {

/// Data bytes of a classical CAN frame at most (ISO 11898-1 §8.4.2).
inline constexpr std::size_t kMaximumData = 8;

/// A classical CAN frame: a data frame, or a remote frame, which asks for one.
struct Frame {
  std::uint32_t identifier = 0;  ///< 11 bits, or 29 of an extended frame
  bool extended = false;
  bool remote = false;      ///< carries no data; `length` is then the length asked for
  std::uint8_t length = 0;  ///< DLC, 0 to 8
  std::array<std::byte, kMaximumData> data{};

  /// The data bytes; none in a remote frame.
  [[nodiscard]] std::span<const std::byte> payload() const {
    return std::span(data).first(remote ? 0 : length);
  }

  friend bool operator==(const Frame&, const Frame&) = default;
};

/// A data frame with an 11-bit identifier; at most eight bytes are taken.
[[nodiscard]] Frame data_frame(std::uint32_t identifier, std::span<const std::byte> data);
[[nodiscard]] Frame data_frame(std::uint32_t identifier, std::initializer_list<unsigned> data);
/// A remote frame with an 11-bit identifier.
[[nodiscard]] Frame remote_frame(std::uint32_t identifier, std::uint8_t length = 0);

}  // namespace stator::can
