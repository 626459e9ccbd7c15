#include "stator/can/frame.hpp"

#include <algorithm>

namespace stator::can {

Frame data_frame(std::uint32_t identifier, std::span<const std::byte> data) {
  Frame frame{.identifier = identifier,
              .length = static_cast<std::uint8_t>(std::min(data.size(), kMaximumData))};
  std::ranges::copy(data.first(frame.length), frame.data.begin());
  return frame;
}

Frame data_frame(std::uint32_t identifier, std::initializer_list<unsigned> data) {
  Frame frame{.identifier = identifier,
              .length = static_cast<std::uint8_t>(std::min(data.size(), kMaximumData))};
  std::transform(data.begin(), data.begin() + frame.length, frame.data.begin(),
                 [](unsigned byte) { return static_cast<std::byte>(byte); });
  return frame;
}

Frame remote_frame(std::uint32_t identifier, std::uint8_t length) {
  return {.identifier = identifier, .remote = true, .length = length};
}

}  // namespace stator::can
