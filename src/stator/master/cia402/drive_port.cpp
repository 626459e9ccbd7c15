#include "stator/master/cia402/drive_port.hpp"

namespace stator::master {

std::uint64_t load_number(std::span<const std::byte> bytes) {
  std::uint64_t number = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) {
    number = number << 8 | std::to_integer<std::uint64_t>(bytes[i]);
  }
  return number;
}

void store_number(std::span<std::byte> bytes, std::uint64_t number) {
  for (std::byte& byte : bytes) {
    byte = static_cast<std::byte>(number);
    number >>= 8;
  }
}

}  // namespace stator::master
