#include "stator/mfc/registers/register_description.hpp"

#include "stator/mfc/registers/register_map.hpp"

namespace stator::mfc {

namespace {

std::string_view to_string(FieldAccess access) {
  switch (access) {
    case FieldAccess::none:
      return "-";
    case FieldAccess::read:
      return "r";
    case FieldAccess::read_clears:
      return "r+c";
    case FieldAccess::read_write:
      return "r/w";
    case FieldAccess::write:
      return "w";
  }
  return "";
}

/// Four digits, as the document writes addresses.
std::string hexadecimal(unsigned value) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text = "0x";
  for (unsigned shift = 16; shift != 0; shift -= 4) {
    text += kDigits[value >> (shift - 4) & 0xF];
  }
  return text;
}

FieldDescription describe(const RegisterField& field) {
  const Register& entry = kRegisters[field.number];
  FieldDescription row;
  row.number = std::to_string(field.number);
  row.mfc_spi_address = hexadecimal(entry.spi_address());
  row.width_bits = std::to_string(entry.width_bits());
  row.name = entry.name;
  row.bit_hi = std::to_string(field.bit_hi);
  row.bit_lo = std::to_string(field.bit_lo);
  row.field = field.name;
  row.access_ecat = to_string(field.ecat);
  row.access_pdi = to_string(field.pdi);
  row.range = field.range;
  row.reset = field.reserved() ? "" : std::to_string(field.reset);
  row.source_line = field.lines;
  row.notes = field.meaning;
  return row;
}

}  // namespace

std::vector<FieldDescription> describe_fields() {
  std::vector<FieldDescription> rows;
  for (const std::span<const RegisterField> group : register_field_groups()) {
    for (const RegisterField& field : group) {
      rows.push_back(describe(field));
    }
  }
  return rows;
}

}  // namespace stator::mfc
