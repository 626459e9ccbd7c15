#include "stator/mfc/registers/register_map.hpp"

#include <algorithm>

#include "stator/mfc/registers/register_fields.hpp"

namespace stator::mfc {

namespace {

constexpr bool numbered_in_order() {
  for (std::size_t i = 0; i < kRegisters.size(); ++i) {
    if (kRegisters[i].number != i) {
      return false;
    }
  }
  return true;
}
static_assert(numbered_in_order());

}  // namespace

std::array<std::span<const RegisterField>, 3> register_field_groups() {
  return {encoder_and_serial_fields(), generator_fields(), supervision_fields()};
}

std::uint64_t reset_value(unsigned number) {
  std::uint64_t value = 0;
  for (const std::span<const RegisterField> group : register_field_groups()) {
    for (const RegisterField& field : group) {
      if (field.number == number) {
        value |= std::uint64_t{field.reset} << field.bit_lo;
      }
    }
  }
  return value;
}

const Register* find_register(std::string_view name, Direction direction) {
  const auto* const found = std::ranges::find_if(kRegisters, [&](const Register& entry) {
    return entry.direction == direction && entry.name == name;
  });
  return found == kRegisters.end() || direction == Direction::none ? nullptr : found;
}

}  // namespace stator::mfc
