#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "stator/ethercat/registers/register_table.hpp"

namespace stator::ethercat {

/// A row of a table of registers: a register, or a field of the register in the nearest row above
/// that is one. The tables read as those of the documents do.
struct RegisterRow {
  /// A register: address, width in bits, name as printed; what an access causes, the part it
  /// belongs to, how often it occurs, the part without which nobody can write it.
  constexpr RegisterRow(std::uint16_t address, std::uint16_t width, std::string_view name,
                        Effect effect = Effect::none,
                        ControllerFeature feature = ControllerFeature::always,
                        Repetition repetition = {},
                        ControllerFeature write_feature = ControllerFeature::always)
      : declaration{address, width, name, effect, feature, repetition, write_feature, {}, {}} {}
  /// A field: highest and lowest bit, name, rights of bus and host, reset value, document lines.
  constexpr RegisterRow(std::uint16_t bit_hi, std::uint16_t bit_lo, std::string_view name,
                        Access bus, Access host, std::uint64_t reset, DocumentLines lines)
      : field{bit_hi, bit_lo, name, bus, host, reset, lines} {}

  [[nodiscard]] constexpr bool is_register() const { return declaration.width != 0; }

  RegisterDeclaration declaration;
  RegisterField field;
};

/// Bits of `field` within byte `index` of its register.
constexpr std::uint8_t bits_in_byte(const RegisterField& field, std::size_t index) {
  unsigned bits = 0;
  for (unsigned bit = 0; bit < 8; ++bit) {
    const std::size_t at = 8 * index + bit;
    bits |= at >= field.bit_lo && at <= field.bit_hi ? 1U << bit : 0U;
  }
  return static_cast<std::uint8_t>(bits);
}

/// Reset value of `field` within byte `index`.
constexpr std::uint8_t reset_in_byte(const RegisterField& field, std::size_t index) {
  unsigned value = 0;
  for (unsigned bit = 0; bit < 8; ++bit) {
    const std::size_t at = 8 * index + bit;
    const bool set = at >= field.bit_lo && at - field.bit_lo < 64 &&
                     (field.reset >> (at - field.bit_lo) & 1U) != 0;
    value |= set ? 1U << bit : 0U;
  }
  return static_cast<std::uint8_t>(value);
}

/// Adds to `byte`, byte `index` of a register with `effect`, what `field` allows and holds there.
constexpr void add_field(RegisterByte& byte, const RegisterField& field, Effect effect,
                         std::size_t index) {
  const std::uint8_t bits = bits_in_byte(field, index);
  if (bits == 0) {
    return;
  }
  byte.bus_reads |= may_read(field.bus);
  byte.bus_writes |= may_write(field.bus);
  byte.host_reads |= may_read(field.host);
  byte.host_writes |= may_write(field.host);
  byte.reset |= reset_in_byte(field, index);
  if (!field.reserved() && !discards_value(effect)) {
    byte.bus_stores |= stores(field.bus) ? bits : std::uint8_t{0};
    byte.host_stores |= stores(field.host) ? bits : std::uint8_t{0};
  }
}

/// Sets RegisterByte::more of each byte of a register: how many bytes behind it allow the same.
constexpr void count_more(std::span<RegisterByte> bytes) {
  for (std::size_t i = bytes.size(); i-- > 1;) {
    if (bytes[i - 1].allows_same_as(bytes[i])) {
      bytes[i - 1].more = static_cast<std::uint8_t>(std::min(bytes[i].more + 1, 7));
    }
  }
}

/// What a table of rows declares, worked out by the compiler: starting a device only copies.
template <const auto& rows>
class RegisterTable {
 public:
  static constexpr std::span<const RegisterDeclaration> registers() { return kRegisters; }

 private:
  static constexpr std::size_t kRegisterCount =
      static_cast<std::size_t>(std::ranges::count_if(rows, &RegisterRow::is_register));
  static constexpr std::size_t byte_count() {
    std::size_t bits = 0;
    for (const RegisterRow& row : rows) {
      bits += row.declaration.width;
    }
    return bits / 8;
  }
  /// The rows that are fields, in order.
  static constexpr auto fields() {
    std::array<RegisterField, std::ranges::size(rows) - kRegisterCount> fields{};
    std::size_t count = 0;
    for (const RegisterRow& row : rows) {
      if (!row.is_register()) {
        fields[count++] = row.field;
      }
    }
    return fields;
  }
  /// The bytes of all registers, one behind the other.
  static constexpr auto bytes() {
    std::array<RegisterByte, byte_count()> bytes{};
    Effect effect = Effect::none;
    std::span<RegisterByte> own;
    std::span<RegisterByte> rest(bytes);
    for (const RegisterRow& row : rows) {
      if (row.is_register()) {
        count_more(own);
        effect = row.declaration.effect;
        own = rest.first(row.declaration.width / 8U);
        rest = rest.subspan(own.size());
        continue;
      }
      for (std::size_t i = row.field.bit_lo / 8U; i <= row.field.bit_hi / 8U; ++i) {
        add_field(own[i], row.field, effect, i);
      }
    }
    count_more(own);
    return bytes;
  }
  static constexpr auto kFields = fields();
  static constexpr auto kBytes = bytes();

  /// The rows that are registers, each with its fields and bytes.
  static constexpr auto declarations() {
    std::array<RegisterDeclaration, kRegisterCount> declarations{};
    std::size_t count = 0;
    std::size_t first_field = 0;
    std::size_t next_field = 0;
    std::size_t next_byte = 0;
    for (const RegisterRow& row : rows) {
      if (row.is_register()) {
        RegisterDeclaration& declaration = declarations[count++];
        declaration = row.declaration;
        declaration.bytes = std::span(kBytes).subspan(next_byte, declaration.width / 8U);
        next_byte += declaration.width / 8U;
        first_field = next_field;
      } else {
        ++next_field;
        declarations[count - 1].fields =
            std::span(kFields).subspan(first_field, next_field - first_field);
      }
    }
    return declarations;
  }
  static constexpr auto kRegisters = declarations();
};

/// Short names for the cells of the tables.
namespace notation {
using E = Effect;
using F = ControllerFeature;

// NOLINTBEGIN(readability-identifier-naming): the signs of the tables
inline constexpr Access none = Access::none;
inline constexpr Access r = Access::read;
inline constexpr Access r_ack = Access::read_acknowledges;
inline constexpr Access rw = Access::read_write;
inline constexpr Access rw_if = Access::read_write_if;
inline constexpr Access rw_start = Access::read_write_if_starts;
inline constexpr Access rw_ack = Access::read_write_acknowledges;
inline constexpr Access rw_clear = Access::read_write_clears;
inline constexpr Access rw_special = Access::read_write_special;
inline constexpr Access w = Access::write_special;
inline constexpr Access w_if = Access::write_if;
// NOLINTEND(readability-identifier-naming)

inline constexpr Repetition kOnce;
inline constexpr Repetition kEachFmmu{Channels::fmmus, 16};
inline constexpr Repetition kEachSyncManager{Channels::sync_managers, 8};
inline constexpr Repetition kEachPortByte{Channels::ports, 1};
inline constexpr Repetition kEachPortWord{Channels::ports, 2};
}  // namespace notation

// The groups, one file each: register_table_<group>.cpp.
[[nodiscard]] std::span<const RegisterDeclaration> data_link_registers();
[[nodiscard]] std::span<const RegisterDeclaration> application_layer_registers();
[[nodiscard]] std::span<const RegisterDeclaration> event_registers();
[[nodiscard]] std::span<const RegisterDeclaration> sii_and_mii_registers();
[[nodiscard]] std::span<const RegisterDeclaration> fmmu_and_sync_manager_registers();
[[nodiscard]] std::span<const RegisterDeclaration> distributed_clock_registers();
[[nodiscard]] std::span<const RegisterDeclaration> identity_registers();

}  // namespace stator::ethercat
