#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "stator/control/foc/register_fields.hpp"

namespace stator::control::foc {

/// What the host of the FOC block may do with a register.
enum class Access : std::uint8_t { read_only, read_write };

/// One register, or one view of a data register. The datasheet names two addresses only; where
/// `origin` is kList the row comes from the public TMC4671 register list (reading A-02) and its
/// reset value from there or from docs/devices/tmc8670-decisions.md.
struct RegisterDescription {  // NOLINT(clang-analyzer-optin.performance.Padding): columns of a
                              // table
  std::uint8_t address;       ///< 00h..7Fh
  std::int16_t view;          ///< kPlain, or the index that selects it in the register that follows
  std::string_view name;
  Access access;
  std::uint32_t reset;      ///< after power-on; what is measured starts from the inputs
  std::string_view origin;  ///< line of the datasheet, or kList
};

/// Origin of what the datasheet does not say.
inline constexpr std::string_view kList = "TMC4671 public list";

/// Every register, each followed by its views, in the order of addresses.
[[nodiscard]] std::span<const RegisterDescription> registers();

/// The register (view kPlain) or view there; nullptr if there is none.
[[nodiscard]] const RegisterDescription* find_register(std::uint8_t address,
                                                       std::int16_t view = kPlain);
/// The register or view of that name; nullptr if there is none.
[[nodiscard]] const RegisterDescription* find_register(std::string_view name);

/// All fields, in the order of addresses.
[[nodiscard]] std::span<const FieldDescription> fields();

/// Bits that hold something, whether writable or not; 0 if there is no such register.
[[nodiscard]] std::uint32_t implemented_mask(std::uint8_t address, std::int16_t view = kPlain);
/// Bits a write changes: those implemented if the register is writable, else none.
[[nodiscard]] std::uint32_t writable_mask(std::uint8_t address, std::int16_t view = kPlain);

}  // namespace stator::control::foc
