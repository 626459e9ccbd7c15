#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace stator::mfc {

/// One field of a register as text, in the columns of the table made from the document.
struct FieldDescription {
  std::string number;
  std::string mfc_spi_address;
  std::string width_bits;
  std::string name;
  std::string bit_hi;
  std::string bit_lo;
  std::string field;
  std::string access_ecat;  ///< "-", "r", "r+c", "r/w", "w"
  std::string access_pdi;
  std::string range;
  std::string reset;        ///< empty for reserved fields
  std::string source_line;  ///< lines of the datasheet's text
  std::string notes;

  /// The texts in the order of kFieldColumns.
  [[nodiscard]] std::array<std::string_view, 13> columns() const {
    return {number,      mfc_spi_address, width_bits, name,  bit_hi,      bit_lo, field,
            access_ecat, access_pdi,      range,      reset, source_line, notes};
  }
};

inline constexpr std::array<std::string_view, 13> kFieldColumns{
    "number",      "mfc_spi_address", "width_bits", "name",  "bit_hi",      "bit_lo", "field",
    "access_ecat", "access_pdi",      "range",      "reset", "source_line", "notes"};

/// All fields of all registers, by register and bit.
[[nodiscard]] std::vector<FieldDescription> describe_fields();

}  // namespace stator::mfc
