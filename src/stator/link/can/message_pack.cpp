#include "stator/link/can/message_pack.hpp"

#include <bit>

namespace stator::link {

namespace {

// First bytes of values.
constexpr unsigned kFixMap = 0x80;
constexpr unsigned kFixArray = 0x90;
constexpr unsigned kFixText = 0xA0;
constexpr unsigned kNil = 0xC0;
constexpr unsigned kFalse = 0xC2;
constexpr unsigned kTrue = 0xC3;
constexpr unsigned kBinary8 = 0xC4;
constexpr unsigned kExtension8 = 0xC7;
constexpr unsigned kFloat32 = 0xCA;
constexpr unsigned kFloat64 = 0xCB;
constexpr unsigned kUnsigned8 = 0xCC;
constexpr unsigned kUnsigned16 = 0xCD;
constexpr unsigned kUnsigned32 = 0xCE;
constexpr unsigned kUnsigned64 = 0xCF;
constexpr unsigned kSigned8 = 0xD0;
constexpr unsigned kFixExtension1 = 0xD4;
constexpr unsigned kText8 = 0xD9;
constexpr unsigned kArray16 = 0xDC;
constexpr unsigned kMap16 = 0xDE;
constexpr unsigned kMap32 = 0xDF;
constexpr unsigned kNegativeFix = 0xE0;

constexpr unsigned kFixTextMaximum = 31;
constexpr unsigned kFixNumberMaximum = 0x7F;

}  // namespace

void MessagePackWriter::byte(unsigned value) {
  if (size_ < buffer_.size()) {
    buffer_[size_++] = static_cast<std::byte>(value);
  }
}

void MessagePackWriter::big_endian(std::uint64_t value, unsigned bytes) {
  for (unsigned shift = 8 * bytes; shift > 0;) {
    shift -= 8;
    byte(static_cast<unsigned>(value >> shift & 0xFF));
  }
}

void MessagePackWriter::map(unsigned entries) {
  byte(kFixMap | entries);
}

void MessagePackWriter::text(std::string_view value) {
  byte(kFixText | static_cast<unsigned>(value.size()));
  for (const char each : value) {
    byte(static_cast<unsigned char>(each));
  }
}

void MessagePackWriter::number(double value) {
  byte(kFloat64);
  big_endian(std::bit_cast<std::uint64_t>(value), 8);
}

void MessagePackWriter::number(std::uint32_t value) {
  if (value <= kFixNumberMaximum) {
    byte(value);
  } else if (value <= 0xFF) {
    byte(kUnsigned8);
    big_endian(value, 1);
  } else if (value <= 0xFFFF) {
    byte(kUnsigned16);
    big_endian(value, 2);
  } else {
    byte(kUnsigned32);
    big_endian(value, 4);
  }
}

void MessagePackWriter::boolean(bool value) {
  byte(value ? kTrue : kFalse);
}

void MessagePackWriter::nil() {
  byte(kNil);
}

void MessagePackWriter::binary(std::span<const std::byte> value) {
  byte(kBinary8);
  big_endian(value.size(), 1);
  for (const std::byte each : value) {
    byte(std::to_integer<unsigned>(each));
  }
}

std::optional<unsigned> MessagePackReader::byte() {
  if (rest_.empty()) {
    return std::nullopt;
  }
  const auto value = std::to_integer<unsigned>(rest_.front());
  rest_ = rest_.subspan(1);
  return value;
}

std::optional<std::uint64_t> MessagePackReader::big_endian(unsigned bytes) {
  const auto taken = take(bytes);
  if (!taken) {
    return std::nullopt;
  }
  std::uint64_t value = 0;
  for (const std::byte each : *taken) {
    value = value << 8 | std::to_integer<std::uint64_t>(each);
  }
  return value;
}

std::optional<std::span<const std::byte>> MessagePackReader::take(std::uint64_t size) {
  if (size > rest_.size()) {
    return std::nullopt;
  }
  const auto taken = rest_.first(static_cast<std::size_t>(size));
  rest_ = rest_.subspan(taken.size());
  return taken;
}

std::optional<std::uint32_t> MessagePackReader::map() {
  const auto type = byte();
  if (!type) {
    return std::nullopt;
  }
  if ((*type & 0xF0) == kFixMap) {
    return *type & 0x0F;
  }
  if (*type == kMap16 || *type == kMap32) {
    const auto entries = big_endian(*type == kMap16 ? 2 : 4);
    return entries ? std::optional(static_cast<std::uint32_t>(*entries)) : std::nullopt;
  }
  return std::nullopt;
}

std::optional<std::string_view> MessagePackReader::text() {
  const auto type = byte();
  std::optional<std::uint64_t> size;
  if (type && (*type & ~kFixTextMaximum) == kFixText) {
    size = *type & kFixTextMaximum;
  } else if (type && *type >= kText8 && *type < kText8 + 3) {
    size = big_endian(1U << (*type - kText8));
  }
  const auto taken = size ? take(*size) : std::nullopt;
  if (!taken) {
    return std::nullopt;
  }
  return std::string_view(reinterpret_cast<const char*>(taken->data()), taken->size());
}

std::optional<std::uint64_t> MessagePackReader::unsigned_number() {
  const auto type = byte();
  if (!type) {
    return std::nullopt;
  }
  if (*type <= kFixNumberMaximum) {
    return *type;
  }
  if (*type >= kUnsigned8 && *type <= kUnsigned64) {
    return big_endian(1U << (*type - kUnsigned8));
  }
  if (*type >= kSigned8 && *type < kSigned8 + 4) {
    const unsigned bytes = 1U << (*type - kSigned8);
    const auto value = big_endian(bytes);
    // Negative numbers give nothing.
    return value && *value >> (8 * bytes - 1) == 0 ? value : std::nullopt;
  }
  return std::nullopt;
}

std::optional<bool> MessagePackReader::boolean() {
  const auto type = byte();
  if (!type || (*type != kFalse && *type != kTrue)) {
    return std::nullopt;
  }
  return *type == kTrue;
}

std::optional<std::span<const std::byte>> MessagePackReader::binary() {
  const auto type = byte();
  if (!type || *type < kBinary8 || *type >= kBinary8 + 3) {
    return std::nullopt;
  }
  const auto size = big_endian(1U << (*type - kBinary8));
  return size ? take(*size) : std::nullopt;
}

bool MessagePackReader::next_is_nil() const {
  return !rest_.empty() && std::to_integer<unsigned>(rest_.front()) == kNil;
}

bool MessagePackReader::skip_values(std::uint64_t count, int depth) {
  if (depth == 0) {
    return false;
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!skip(depth - 1)) {
      return false;
    }
  }
  return true;
}

bool MessagePackReader::skip(int depth) {
  const auto type = byte();
  if (!type) {
    return false;
  }
  const auto skip_sized = [&](unsigned size_bytes, unsigned more) {
    const auto size = big_endian(size_bytes);
    return size && take(*size + more).has_value();
  };
  const unsigned t = *type;
  if (t <= kFixNumberMaximum || t >= kNegativeFix || t == kNil || t == kFalse || t == kTrue) {
    return true;
  }
  if (t < kFixArray) {
    return skip_values(std::uint64_t{2} * (t & 0x0F), depth);
  }
  if (t < kFixText) {
    return skip_values(t & 0x0F, depth);
  }
  if (t < kNil) {
    return take(t & kFixTextMaximum).has_value();
  }
  if (t >= kBinary8 && t < kBinary8 + 3) {
    return skip_sized(1U << (t - kBinary8), 0);
  }
  if (t >= kExtension8 && t < kExtension8 + 3) {
    return skip_sized(1U << (t - kExtension8), 1);
  }
  if (t == kFloat32 || t == kFloat64) {
    return take(t == kFloat32 ? 4 : 8).has_value();
  }
  if (t >= kUnsigned8 && t <= kUnsigned64) {
    return take(1U << (t - kUnsigned8)).has_value();
  }
  if (t >= kSigned8 && t < kSigned8 + 4) {
    return take(1U << (t - kSigned8)).has_value();
  }
  if (t >= kFixExtension1 && t < kFixExtension1 + 5) {
    return take(1 + (1U << (t - kFixExtension1))).has_value();
  }
  if (t >= kText8 && t < kText8 + 3) {
    return skip_sized(1U << (t - kText8), 0);
  }
  if (t >= kArray16 && t <= kMap32) {
    const bool is_map = t >= kMap16;
    const auto count = big_endian((t - kArray16) % 2 == 0 ? 2 : 4);
    return count && skip_values(*count * (is_map ? 2 : 1), depth);
  }
  return false;
}

}  // namespace stator::link
