#include "stator/master/cia402/drive_port.hpp"

#include "stator/master/text.hpp"

namespace stator::master {

std::uint64_t load_number(std::span<const std::byte> bytes) {
  std::uint64_t number = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) {
    number = number << 8 | std::to_integer<std::uint64_t>(bytes[i]);
  }
  return number;
}

Result<std::uint64_t> number_of(std::span<const std::byte> bytes, std::size_t size,
                                ObjectAddress object, const std::string& name) {
  if (bytes.size() != size) {
    return fail(ErrorCode::protocol, to_text(object) + " of " + name + " has " +
                                         std::to_string(bytes.size()) + " bytes, " +
                                         std::to_string(size) + " were expected");
  }
  return load_number(bytes);
}

void store_number(std::span<std::byte> bytes, std::uint64_t number) {
  for (std::byte& byte : bytes) {
    byte = static_cast<std::byte>(number);
    number >>= 8;
  }
}

}  // namespace stator::master
