#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "stator/ethercat/standard/frame.hpp"

// Frames as tests write them: bytes, numbers, and what came back of each datagram.
namespace stator::ethercat::testing {

using Bytes = std::vector<std::byte>;

inline Bytes bytes(std::initializer_list<unsigned> values) {
  Bytes result;
  for (const unsigned value : values) {
    result.push_back(static_cast<std::byte>(value));
  }
  return result;
}

inline Bytes zeros(std::size_t length) {
  return Bytes(length);
}

/// `value` as `length` little-endian bytes.
inline Bytes little_endian(std::uint64_t value, std::size_t length) {
  Bytes result;
  for (std::size_t i = 0; i < length; ++i) {
    result.push_back(static_cast<std::byte>(value >> (8 * i)));
  }
  return result;
}

inline std::uint64_t number(std::span<const std::byte> data) {
  std::uint64_t value = 0;
  for (std::size_t i = data.size(); i > 0; --i) {
    value = value << 8 | std::to_integer<std::uint64_t>(data[i - 1]);
  }
  return value;
}

/// What came back of one datagram.
struct Answer {
  bool returned = false;
  unsigned working_counter = 0;
  unsigned interrupt = 0;
  std::uint32_t address = 0;
  Bytes data;
  bool circulating = false;
};

/// Datagrams queued for one frame, and their answers once it has passed the slaves.
class RawFrame {
 public:
  RawFrame() = default;
  RawFrame(const RawFrame&) = delete;
  RawFrame& operator=(const RawFrame&) = delete;

  void append(Command command, std::uint32_t address, const Bytes& data) {
    builder_.append(command, static_cast<std::uint8_t>(queued_++), address, data);
  }
  /// The frame to send; no shorter than it has to be, as masters send it on virtual links.
  [[nodiscard]] std::span<std::byte> finish() {
    frame_ = builder_.finish();
    return frame_;
  }
  /// One answer per datagram, `returned` or not; the next frame is empty.
  std::vector<Answer> take_answers(bool returned) {
    std::vector<Answer> answers;
    DatagramCursor cursor(frame_);
    while (const auto datagram = cursor.next()) {
      const std::span<std::byte> data = datagram->bytes();
      answers.push_back({returned, datagram->working_counter, datagram->interrupt,
                         datagram->address, Bytes(data.begin(), data.end()),
                         datagram->circulating});
    }
    builder_ = FrameBuilder(buffer_, kMaster);
    queued_ = 0;
    return answers;
  }

 private:
  static constexpr MacAddress kMaster{0x01, 0x01, 0x01, 0x01, 0x01, 0x01};

  std::array<std::byte, kMaximumFrameLength> buffer_{};
  FrameBuilder builder_{buffer_, kMaster};
  std::span<std::byte> frame_;
  unsigned queued_ = 0;
};

}  // namespace stator::ethercat::testing
