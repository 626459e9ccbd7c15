#include "stator/dictionary/content.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace stator::dictionary {

namespace {

std::uint64_t from_little_endian(std::span<const std::byte> bytes) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < bytes.size() && i < sizeof bits; ++i) {
    bits |= std::to_integer<std::uint64_t>(bytes[i]) << (8 * i);
  }
  return bits;
}

std::vector<std::byte> to_little_endian(std::uint64_t bits, std::size_t length) {
  std::vector<std::byte> bytes(length);
  for (std::size_t i = 0; i < length; ++i) {
    bytes[i] = static_cast<std::byte>(bits >> (8 * i));
  }
  return bytes;
}

std::int64_t sign_extended(std::uint64_t bits, std::size_t length) {
  const auto unused = static_cast<unsigned>(64 - 8 * length);
  return static_cast<std::int64_t>(bits << unused) >> unused;
}

/// A whole number with its sign, as two's complement.
struct Whole {
  std::uint64_t bits = 0;
  bool negative = false;
};

std::optional<Whole> whole_of(const Content& content) {
  if (const auto* number = std::get_if<std::int64_t>(&content)) {
    return Whole{static_cast<std::uint64_t>(*number), *number < 0};
  }
  if (const auto* number = std::get_if<std::uint64_t>(&content)) {
    return Whole{*number};
  }
  return std::nullopt;
}

std::optional<double> real_of(const Content& content) {
  if (const auto* number = std::get_if<double>(&content)) {
    return *number;
  }
  if (const std::optional<Whole> whole = whole_of(content)) {
    return whole->negative ? static_cast<double>(static_cast<std::int64_t>(whole->bits))
                           : static_cast<double>(whole->bits);
  }
  return std::nullopt;
}

bool fits(const Whole& whole, DataType type) {
  const std::size_t bits = bit_length(type);
  if (is_signed(type)) {
    const std::uint64_t limit = std::uint64_t{1} << (bits - 1);
    return whole.negative ? ~whole.bits + 1 <= limit : whole.bits < limit;
  }
  return !whole.negative && (bits == 64 || whole.bits >> bits == 0);
}

std::optional<std::vector<std::byte>> encode_real(DataType type, const Content& content) {
  const std::optional<double> number = real_of(content);
  if (!number) {
    return std::nullopt;
  }
  if (type == DataType::real64) {
    return to_little_endian(std::bit_cast<std::uint64_t>(*number), sizeof(double));
  }
  const auto shorter = static_cast<float>(*number);
  if (!std::isfinite(shorter)) {
    return std::nullopt;
  }
  return to_little_endian(std::bit_cast<std::uint32_t>(shorter), sizeof(float));
}

std::optional<std::vector<std::byte>> encode_text(const Content& content) {
  if (const auto* text = std::get_if<std::string>(&content)) {
    const auto bytes = std::as_bytes(std::span(*text));
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  }
  return std::nullopt;
}

std::optional<std::vector<std::byte>> encode_bytes(const Content& content) {
  const auto* bytes = std::get_if<std::vector<std::byte>>(&content);
  return bytes != nullptr ? std::optional(*bytes) : std::nullopt;
}

std::optional<std::vector<std::byte>> encode_whole(DataType type, const Content& content) {
  if (const auto* truth = std::get_if<bool>(&content)) {
    return type == DataType::boolean ? std::optional(to_little_endian(*truth ? 1 : 0, 1))
                                     : std::nullopt;
  }
  const std::optional<Whole> whole = whole_of(content);
  if (!whole || !fits(*whole, type)) {
    return std::nullopt;
  }
  return to_little_endian(whole->bits, byte_length(type));
}

}  // namespace

Content decode(DataType type, std::span<const std::byte> bytes) {
  const std::uint64_t bits = from_little_endian(bytes);
  switch (type) {
    case DataType::boolean:
      return bits != 0;
    case DataType::visible_string:
      return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    case DataType::octet_string:
    case DataType::unicode_string:
    case DataType::domain:
      return std::vector<std::byte>(bytes.begin(), bytes.end());
    case DataType::real32:
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    case DataType::real64:
      return std::bit_cast<double>(bits);
    default:
      break;
  }
  if (is_signed(type) && !bytes.empty()) {
    return sign_extended(bits, std::min(bytes.size(), sizeof bits));
  }
  return bits;
}

std::optional<std::vector<std::byte>> encode(DataType type, const Content& content) {
  switch (type) {
    case DataType::visible_string:
      return encode_text(content);
    case DataType::octet_string:
    case DataType::unicode_string:
    case DataType::domain:
      return encode_bytes(content);
    case DataType::real32:
    case DataType::real64:
      return encode_real(type, content);
    default:
      return encode_whole(type, content);
  }
}

}  // namespace stator::dictionary
