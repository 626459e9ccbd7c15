#include "stator/ethercat/units/fmmu.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"

namespace stator::ethercat {

std::optional<Fmmu> Fmmu::decode(std::span<const std::byte, kRegisterLength> registers) {
  const std::span<const std::byte> bytes = registers;
  const auto octet = [&](std::size_t offset) {
    return std::to_integer<std::uint8_t>(bytes[offset]);
  };
  Fmmu fmmu;
  fmmu.logical_start = base::load_le<std::uint32_t>(bytes, 0);
  fmmu.length = base::load_le<std::uint16_t>(bytes, 4);
  fmmu.logical_start_bit = octet(6) & 0x07;
  fmmu.logical_stop_bit = octet(7) & 0x07;
  fmmu.physical_start = base::load_le<std::uint16_t>(bytes, 8);
  fmmu.physical_start_bit = octet(10) & 0x07;
  fmmu.reads = (octet(11) & 0x01) != 0;
  fmmu.writes = (octet(11) & 0x02) != 0;
  const bool active = (octet(12) & 0x01) != 0;
  const bool maps_something = fmmu.length != 0 && fmmu.end_bit() > fmmu.first_bit();
  if (!active || !maps_something || !(fmmu.reads || fmmu.writes)) {
    return std::nullopt;
  }
  return fmmu;
}

void copy_bits(std::byte* destination, std::size_t destination_bit, const std::byte* source,
               std::size_t source_bit, std::size_t count) {
  while (count > 0) {
    const std::size_t to = destination_bit % 8;
    const std::size_t from = source_bit % 8;
    const std::size_t chunk = std::min({count, 8 - to, 8 - from});
    const unsigned mask = ((1U << chunk) - 1U) << to;
    const unsigned bits = std::to_integer<unsigned>(source[source_bit / 8]) >> from << to;
    std::byte& target = destination[destination_bit / 8];
    target = static_cast<std::byte>((std::to_integer<unsigned>(target) & ~mask) | (bits & mask));
    destination_bit += chunk;
    source_bit += chunk;
    count -= chunk;
  }
}

}  // namespace stator::ethercat
