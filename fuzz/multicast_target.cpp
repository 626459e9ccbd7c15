// Datagrams of python-can's multicast interface: any bytes. A frame that is read can be on a bus,
// and written again it is read as the same one.

#include <cstdint>

#include "input.hpp"
#include "stator/link/can/multicast_message.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stator::link;
  const auto decoded = decode_multicast({reinterpret_cast<const std::byte*>(data), size});
  if (decoded.content == MulticastContent::frame) {
    const auto& frame = decoded.frame;
    stator::fuzz::require(frame.length <= stator::can::kMaximumData &&
                          frame.identifier <= (frame.extended ? 0x1FFFFFFFU : 0x7FFU));
    const auto again = decode_multicast(encode_multicast(frame, {}).content());
    stator::fuzz::require(again.content == MulticastContent::frame && again.frame == frame);
  }
  return 0;
}
