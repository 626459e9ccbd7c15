// How recordings hold a CAN frame: identifier, a byte of flags, length, data.
#pragma once

#include <algorithm>

#include "stator/can/frame.hpp"
#include "stator/replay/byte_coding.hpp"

namespace stator::replay {

inline void write_can_frame(ByteWriter& writer, const can::Frame& frame) {
  writer.number(frame.identifier);
  writer.byte((frame.extended ? 1U : 0U) | (frame.remote ? 2U : 0U));
  writer.byte(frame.length);
  writer.raw(frame.payload());
}

[[nodiscard]] inline can::Frame read_can_frame(ByteReader& reader) {
  can::Frame frame;
  frame.identifier = static_cast<std::uint32_t>(reader.number());
  const unsigned flags = reader.byte();
  frame.extended = (flags & 1U) != 0;
  frame.remote = (flags & 2U) != 0;
  frame.length = static_cast<std::uint8_t>(std::min<unsigned>(reader.byte(), can::kMaximumData));
  std::ranges::copy(reader.raw(frame.payload().size()), frame.data.begin());
  return frame;
}

}  // namespace stator::replay
