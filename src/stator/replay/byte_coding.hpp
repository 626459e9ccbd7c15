#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stator::replay {

/// Appends values to a buffer: numbers in groups of seven bits, the lowest first.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& buffer) : buffer_(buffer) {}

  void byte(unsigned value) { buffer_.push_back(static_cast<std::byte>(value)); }
  void number(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7U) {
      byte(static_cast<unsigned>(value & 0x7FU) | 0x80U);
    }
    byte(static_cast<unsigned>(value));
  }
  /// Small numbers of either sign are short.
  void signed_number(std::int64_t value) {
    number((static_cast<std::uint64_t>(value) << 1U) ^ static_cast<std::uint64_t>(value >> 63));
  }
  void real(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (unsigned shift = 0; shift < 64; shift += 8) {
      byte(static_cast<unsigned>((bits >> shift) & 0xFFU));
    }
  }
  void raw(std::span<const std::byte> bytes) {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  }
  void bytes(std::span<const std::byte> bytes) {
    number(bytes.size());
    raw(bytes);
  }
  void text(std::string_view text) { bytes(std::as_bytes(std::span(text))); }

 private:
  std::vector<std::byte>& buffer_;
};

/// Reads what a ByteWriter wrote. After a value that is not there good() is false and everything
/// reads as 0 or empty.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }

  unsigned byte() {
    if (rest_.empty()) {
      good_ = false;
      return 0;
    }
    const auto value = std::to_integer<unsigned>(rest_.front());
    rest_ = rest_.subspan(1);
    return value;
  }
  std::uint64_t number() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const unsigned next = byte();
      value |= std::uint64_t{next & 0x7FU} << shift;
      if ((next & 0x80U) == 0) {
        return value;
      }
    }
    good_ = false;
    return 0;
  }
  std::int64_t signed_number() {
    const std::uint64_t value = number();
    return static_cast<std::int64_t>((value >> 1U) ^ (0 - (value & 1U)));
  }
  double real() {
    std::uint64_t bits = 0;
    for (unsigned shift = 0; shift < 64; shift += 8) {
      bits |= std::uint64_t{byte()} << shift;
    }
    return std::bit_cast<double>(bits);
  }
  std::span<const std::byte> raw(std::uint64_t count) {
    if (count > rest_.size()) {
      good_ = false;
      rest_ = {};
      return {};
    }
    const auto bytes = rest_.first(static_cast<std::size_t>(count));
    rest_ = rest_.subspan(static_cast<std::size_t>(count));
    return bytes;
  }
  std::span<const std::byte> bytes() { return raw(number()); }
  std::string text() {
    const auto letters = bytes();
    return {reinterpret_cast<const char*>(letters.data()),
            letters.size()};  // NOLINT: bytes of text
  }

 private:
  std::span<const std::byte> rest_;
  bool good_ = true;
};

}  // namespace stator::replay
