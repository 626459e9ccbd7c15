#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

namespace stator::base {

// EtherCAT, CANopen and the object dictionary are little-endian; TMCL is big-endian. On a
// little-endian host load_le and store_le compile to one plain move.

namespace detail {
template <typename T>
constexpr T reverse_bytes(T value) {
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
  for (std::size_t i = 0; i < sizeof(T) / 2; ++i) {
    std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
  }
  return std::bit_cast<T>(bytes);
}
}  // namespace detail

/// Reads a little-endian T at `from`; `from` must have sizeof(T) readable bytes, any alignment.
template <typename T>
requires std::is_trivially_copyable_v<T>
[[nodiscard]] T load_le(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  if constexpr (std::endian::native == std::endian::big && sizeof(T) > 1) {
    value = detail::reverse_bytes(value);
  }
  return value;
}

/// Writes `value` little-endian at `to`; `to` must have sizeof(T) writable bytes, any alignment.
template <typename T>
requires std::is_trivially_copyable_v<T>
void store_le(std::byte* to, T value) {
  if constexpr (std::endian::native == std::endian::big && sizeof(T) > 1) {
    value = detail::reverse_bytes(value);
  }
  std::memcpy(to, &value, sizeof value);
}

/// Reads a little-endian T at `bytes[offset]`; the caller has checked that it lies inside.
template <typename T>
[[nodiscard]] T load_le(std::span<const std::byte> bytes, std::size_t offset = 0) {
  return load_le<T>(bytes.data() + offset);
}

/// Writes `value` little-endian at `bytes[offset]`; the caller has checked that it fits.
template <typename T>
void store_le(std::span<std::byte> bytes, std::size_t offset, T value) {
  store_le<T>(bytes.data() + offset, value);
}

}  // namespace stator::base
