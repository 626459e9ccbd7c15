#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

namespace stator::tmcl {

/// What the number of a parameter counts. The two of motion are converted where a module works in
/// units of its chip or in microsteps per second, as its user wants.
enum class ParameterUnit : std::uint8_t {
  none,
  flag,
  bits,
  enumeration,
  microsteps,
  velocity,      ///< of the chip, or microsteps/s
  acceleration,  ///< of the chip, or microsteps/s^2
  current_scale,
  milliseconds,
  other,  ///< as `unit_text` says
};

/// The values a parameter takes, both ends included.
struct ParameterRange {
  std::int32_t minimum = std::numeric_limits<std::int32_t>::min();
  std::int32_t maximum = std::numeric_limits<std::int32_t>::max();

  [[nodiscard]] constexpr bool contains(std::int32_t value) const {
    return value >= minimum && value <= maximum;
  }
};

/// One axis or global parameter of a module: from it follow what commands accept and refuse, what
/// is stored, its lines in lists and in the assembler.
struct ParameterDeclaration {
  std::uint8_t number = 0;
  std::uint8_t bank = 0;      ///< of a global parameter
  std::string_view name{};    ///< as the document has it
  std::string_view symbol{};  ///< for programs, e.g. "MAX_CURRENT"; unique in its module
  bool writable = true;
  bool stored = false;  ///< can be kept in the EEPROM and comes back at power-on
  /// Can be kept in the EEPROM and be restored by command, but does not come back at power-on.
  bool storable = false;
  std::int32_t minimum = std::numeric_limits<std::int32_t>::min();
  std::int32_t maximum = std::numeric_limits<std::int32_t>::max();
  std::int32_t initial = 0;  ///< factory default
  ParameterUnit unit = ParameterUnit::none;
  std::string_view unit_text{};  ///< in words, for people
  std::string_view source{};     ///< lines of the module's document
  std::string_view notes{};      ///< for people

  [[nodiscard]] constexpr ParameterRange range() const { return {minimum, maximum}; }
};

}  // namespace stator::tmcl
