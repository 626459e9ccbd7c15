#include "stator/ethercat/standard/frame.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"

namespace stator::ethercat {

namespace {

using base::load_le;
using base::store_le;

constexpr std::size_t kEtherTypeOffset = 12;
constexpr std::size_t kLengthOffset = 6;     // within the datagram header
constexpr std::size_t kInterruptOffset = 8;  // within the datagram header
constexpr unsigned kLengthMask = 0x07FF;
constexpr unsigned kCirculatingBit = 0x4000;
constexpr unsigned kMoreBit = 0x8000;

std::uint16_t ether_type(std::span<const std::byte> frame) {
  return static_cast<std::uint16_t>(std::to_integer<unsigned>(frame[kEtherTypeOffset]) << 8 |
                                    std::to_integer<unsigned>(frame[kEtherTypeOffset + 1]));
}

/// The frame as it were without a VLAN tag: the EtherType stands at kEtherTypeOffset.
template <typename Byte>
std::span<Byte> untagged(std::span<Byte> frame) {
  return frame.size() >= kFirstDatagramOffset + kVlanTagLength &&
                 ether_type(frame) == kVlanEtherType
             ? frame.subspan(kVlanTagLength)
             : frame;
}

}  // namespace

bool is_ethercat(std::span<const std::byte> frame) {
  return frame.size() >= kFirstDatagramOffset && ether_type(untagged(frame)) == kEtherType;
}

void DatagramView::store() const {
  std::byte* header = data - kDatagramHeaderLength;
  store_le(header + 2, address);
  const auto flags = static_cast<std::uint16_t>(length | (circulating ? kCirculatingBit : 0U) |
                                                (more ? kMoreBit : 0U));
  store_le(header + kLengthOffset, flags);
  store_le(header + kInterruptOffset, interrupt);
  store_le(data + length, working_counter);
}

DatagramCursor::DatagramCursor(std::span<std::byte> frame) {
  if (frame.size() < kFirstDatagramOffset) {
    error_ = FrameError::too_short;
    return;
  }
  frame = untagged(frame);
  if (ether_type(frame) != kEtherType) {
    error_ = FrameError::other_ether_type;
    return;
  }
  const unsigned header = load_le<std::uint16_t>(frame, kEthernetHeaderLength);
  if (header >> 12 != kDatagramHeaderType) {
    error_ = FrameError::other_header_type;
    return;
  }
  const std::size_t announced = header & kLengthMask;
  const std::size_t present = frame.size() - kFirstDatagramOffset;
  if (announced > present) {
    error_ = FrameError::length_overrun;
  }
  rest_ = frame.subspan(kFirstDatagramOffset, std::min(announced, present));
  more_ = true;
}

bool DatagramCursor::next(DatagramView& view) {
  if (!more_) {
    return false;
  }
  more_ = false;
  if (rest_.size() < kDatagramOverhead) {
    note_overrun();
    return false;
  }
  std::byte* const header = rest_.data();
  const unsigned flags = load_le<std::uint16_t>(header + kLengthOffset);
  const std::size_t length = flags & kLengthMask;
  if (rest_.size() < kDatagramOverhead + length) {
    note_overrun();
    return false;
  }
  view.data = header + kDatagramHeaderLength;
  view.command = static_cast<Command>(std::to_integer<std::uint8_t>(header[0]));
  view.index = std::to_integer<std::uint8_t>(header[1]);
  view.address = load_le<std::uint32_t>(header + 2);
  view.length = static_cast<std::uint16_t>(length);
  view.circulating = (flags & kCirculatingBit) != 0;
  view.more = (flags & kMoreBit) != 0;
  view.interrupt = load_le<std::uint16_t>(header + kInterruptOffset);
  view.working_counter = load_le<std::uint16_t>(view.data + length);
  more_ = view.more;
  rest_ = rest_.subspan(kDatagramOverhead + length);
  return true;
}

std::optional<DatagramView> DatagramCursor::next() {
  DatagramView view;
  return next(view) ? std::optional(view) : std::nullopt;
}

void DatagramCursor::note_overrun() {
  error_ = error_ == FrameError::none ? FrameError::datagram_overrun : error_;
}

FrameBuilder::FrameBuilder(std::span<std::byte> buffer, const MacAddress& source,
                           const MacAddress& destination)
    : buffer_(buffer.first(std::min(buffer.size(), kMaximumFrameLength))) {
  std::transform(destination.begin(), destination.end(), buffer_.begin(),
                 [](std::uint8_t octet) { return std::byte{octet}; });
  std::transform(source.begin(), source.end(), buffer_.begin() + 6,
                 [](std::uint8_t octet) { return std::byte{octet}; });
  buffer_[kEtherTypeOffset] = std::byte{kEtherType >> 8};
  buffer_[kEtherTypeOffset + 1] = std::byte{kEtherType & 0xFF};
}

std::optional<std::span<std::byte>> FrameBuilder::append(Command command, std::uint8_t index,
                                                         std::uint32_t address,
                                                         std::size_t length) {
  if (length > kLengthMask || used_ + kDatagramOverhead + length > buffer_.size()) {
    return std::nullopt;
  }
  if (last_datagram_ != 0) {
    buffer_[last_datagram_ + kLengthOffset + 1] |= std::byte{kMoreBit >> 8};
  }
  last_datagram_ = used_;
  const std::span<std::byte> datagram = buffer_.subspan(used_, kDatagramOverhead + length);
  std::fill(datagram.begin(), datagram.end(), std::byte{0});
  datagram[0] = static_cast<std::byte>(command);
  datagram[1] = std::byte{index};
  store_le(datagram, 2, address);
  store_le(datagram, kLengthOffset, static_cast<std::uint16_t>(length));
  used_ += datagram.size();
  return datagram.subspan(kDatagramHeaderLength, length);
}

std::optional<std::span<std::byte>> FrameBuilder::append(Command command, std::uint8_t index,
                                                         std::uint32_t address,
                                                         std::span<const std::byte> data) {
  const auto room = append(command, index, address, data.size());
  if (room) {
    std::copy(data.begin(), data.end(), room->begin());
  }
  return room;
}

std::span<std::byte> FrameBuilder::finish(bool pad) {
  const auto header =
      static_cast<std::uint16_t>((used_ - kFirstDatagramOffset) | kDatagramHeaderType << 12);
  store_le(buffer_, kEthernetHeaderLength, header);
  std::size_t length = used_;
  if (pad && length < kMinimumFrameLength && buffer_.size() >= kMinimumFrameLength) {
    std::fill(buffer_.begin() + static_cast<std::ptrdiff_t>(length),
              buffer_.begin() + kMinimumFrameLength, std::byte{0});
    length = kMinimumFrameLength;
  }
  return buffer_.first(length);
}

}  // namespace stator::ethercat
