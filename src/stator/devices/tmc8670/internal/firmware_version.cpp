#include "stator/devices/tmc8670/internal/firmware_version.hpp"

#include <cstdint>
#include <string_view>

#include "stator/base/crc32.hpp"

namespace stator::devices::tmc8670 {

namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::size_t digits(std::string_view text) {
  constexpr std::size_t kMost = 3;
  std::size_t count = 0;
  while (count < text.size() && count < kMost && is_digit(text[count])) {
    ++count;
  }
  return count;
}

/// The version that `text` begins with; empty if it is none.
std::string_view version_at(std::string_view text) {
  if (text.empty() || text.front() != 'V') {
    return {};
  }
  const std::size_t major = digits(text.substr(1));
  const std::size_t point = 1 + major;
  if (major == 0 || point >= text.size() || text[point] != '.') {
    return {};
  }
  const std::size_t minor = digits(text.substr(point + 1));
  return minor == 0 ? std::string_view() : text.substr(0, point + 1 + minor);
}

}  // namespace

std::string firmware_version(std::span<const std::byte> image) {
  if (image.empty()) {
    return "V1.00";
  }
  const std::string_view text(reinterpret_cast<const char*>(image.data()), image.size());
  for (std::size_t at = text.find('V'); at != std::string_view::npos; at = text.find('V', at + 1)) {
    if (const std::string_view version = version_at(text.substr(at)); !version.empty()) {
      return std::string(version);
    }
  }
  std::string name = "image ";
  const std::uint32_t crc = base::crc32(image);
  for (int shift = 28; shift >= 0; shift -= 4) {
    name += "0123456789ABCDEF"[crc >> shift & 0xFU];
  }
  return name;
}

}  // namespace stator::devices::tmc8670
