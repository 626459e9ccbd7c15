#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "stator/ethercat/controller/controller_preset.hpp"

namespace stator::ethercat {

/// One field of a register as text, in the columns of the register tables made from the documents.
struct RegisterDescription {
  std::string address;
  std::string width_bits;
  std::string name;
  std::string bit_hi;
  std::string bit_lo;
  std::string field;
  std::string access_ecat;  ///< notation of to_string(Access); empty: none
  std::string access_pdi;
  std::string reset;        ///< after power-on, before the EEPROM is loaded
  std::string source_line;  ///< first line of the field in the device's document; empty: not there
  std::string notes;        ///< condition of a conditional right; that a register is not built

  /// The texts in the order of kRegisterColumns.
  [[nodiscard]] std::array<std::string_view, 11> columns() const {
    return {address,     width_bits, name,  bit_hi,      bit_lo, field,
            access_ecat, access_pdi, reset, source_line, notes};
  }
};

inline constexpr std::array<std::string_view, 11> kRegisterColumns{
    "address",     "width_bits", "name",  "bit_hi",      "bit_lo", "field",
    "access_ecat", "access_pdi", "reset", "source_line", "notes"};

/// All fields of all registers of a controller by address, and its process memory as one row at the
/// end. Of the registers not built those that answer are there, as read-only.
[[nodiscard]] std::vector<RegisterDescription> describe_registers(const ControllerPreset& preset);

}  // namespace stator::ethercat
