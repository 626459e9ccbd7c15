#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/byte_order.hpp"

// Messages as tests write and print them.
namespace stator::ethercat::test {

using Bytes = std::vector<std::byte>;

/// "2F 03 20" as bytes.
inline Bytes hex(std::string_view text) {
  Bytes bytes;
  unsigned value = 0;
  int digits = 0;
  for (const char c : text) {
    if (c == ' ') {
      continue;
    }
    value = value * 16 + static_cast<unsigned>(c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10);
    if (++digits == 2) {
      bytes.push_back(static_cast<std::byte>(value));
      value = 0;
      digits = 0;
    }
  }
  return bytes;
}

/// The reverse, for readable failures.
inline std::string to_hex(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text;
  for (const std::byte byte : bytes) {
    if (!text.empty()) {
      text += ' ';
    }
    text += kDigits[std::to_integer<unsigned>(byte) >> 4];
    text += kDigits[std::to_integer<unsigned>(byte) & 15];
  }
  return text;
}

/// `count` bytes from `first` on, fewer if there are not so many.
inline Bytes part(const Bytes& bytes, std::size_t first, std::size_t count = 0xFFFF) {
  first = std::min(first, bytes.size());
  count = std::min(count, bytes.size() - first);
  const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(first);
  return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

inline Bytes concat(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

template <typename T>
Bytes le(T value) {
  Bytes bytes(sizeof value);
  base::store_le(bytes, 0, value);
  return bytes;
}

}  // namespace stator::ethercat::test
