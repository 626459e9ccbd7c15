#include "stator/link/serial/chip_message.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"

namespace stator::link {

using namespace chip_protocol;

ChipMessageReader::ChipMessageReader(std::size_t maximum_body)
    : maximum_body_(maximum_body), buffer_(2 * (kHeaderLength + maximum_body)) {}

std::span<std::byte> ChipMessageReader::space() {
  if (begin_ != 0) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
  return std::span(buffer_).subspan(end_);
}

std::optional<ChipMessage> ChipMessageReader::next() {
  if (broken_ || end_ - begin_ < kHeaderLength) {
    return std::nullopt;
  }
  const std::span<const std::byte> bytes = std::span(buffer_).subspan(begin_, end_ - begin_);
  const std::size_t length = base::load_le<std::uint16_t>(bytes.data());
  if (length > maximum_body_) {
    broken_ = true;
    return std::nullopt;
  }
  if (bytes.size() < kHeaderLength + length) {
    return std::nullopt;
  }
  begin_ += kHeaderLength + length;
  return ChipMessage{.kind = std::to_integer<std::uint8_t>(bytes[2]),
                     .tag = std::to_integer<std::uint8_t>(bytes[3]),
                     .body = bytes.subspan(kHeaderLength, length)};
}

void ChipMessageReader::reset() {
  begin_ = 0;
  end_ = 0;
  broken_ = false;
}

void append_chip_message(std::vector<std::byte>& out, const ChipMessage& message) {
  const std::size_t at = out.size();
  out.resize(at + kHeaderLength);
  base::store_le(out.data() + at, static_cast<std::uint16_t>(message.body.size()));
  out[at + 2] = std::byte{message.kind};
  out[at + 3] = std::byte{message.tag};
  out.insert(out.end(), message.body.begin(), message.body.end());
}

}  // namespace stator::link
