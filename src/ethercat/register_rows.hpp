#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ethercat/register_table.hpp"

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
      : declaration{address, width, name, effect, feature, repetition, write_feature, {}} {}
  /// A field: highest and lowest bit, name, rights of bus and host, reset value, document lines.
  constexpr RegisterRow(std::uint16_t bit_hi, std::uint16_t bit_lo, std::string_view name,
                        Access bus, Access host, std::uint64_t reset, DocumentLines lines)
      : field{bit_hi, bit_lo, name, bus, host, reset, lines} {}

  [[nodiscard]] constexpr bool is_register() const { return declaration.width != 0; }

  RegisterDeclaration declaration;
  RegisterField field;
};

/// The rows that are fields, in order.
template <const auto& rows>
consteval auto fields_of() {
  constexpr auto kIsField = [](const RegisterRow& row) { return !row.is_register(); };
  std::array<RegisterField, std::ranges::count_if(rows, kIsField)> fields{};
  std::size_t count = 0;
  for (const RegisterRow& row : rows) {
    if (kIsField(row)) {
      fields[count++] = row.field;
    }
  }
  return fields;
}

/// The rows that are registers, each with its fields out of `fields`, which is fields_of<rows>().
template <const auto& rows, const auto& fields>
consteval auto registers_of() {
  std::array<RegisterDeclaration, std::ranges::size(rows) - std::ranges::size(fields)> registers{};
  std::size_t count = 0;
  std::size_t first = 0;
  std::size_t next = 0;
  for (const RegisterRow& row : rows) {
    if (row.is_register()) {
      registers[count++] = row.declaration;
      first = next;
    } else {
      ++next;
      registers[count - 1].fields = std::span(fields).subspan(first, next - first);
    }
  }
  return registers;
}

/// Short names for the cells of the tables.
namespace notation {
using E = Effect;
using F = ControllerFeature;

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
