#include "stator/dictionary/description.hpp"

#include <cstddef>
#include <cstdint>

namespace stator::dictionary {

namespace {

std::string hexadecimal(std::uint64_t value, std::size_t digits) {
  std::string text;
  while (value != 0 || text.size() < digits) {
    text.insert(text.begin(), "0123456789ABCDEF"[value & 0xF]);
    value >>= 4;
  }
  return text;
}

std::string decimal(DataType type, const Number& number) {
  return is_signed(type) ? std::to_string(number.as_signed()) : std::to_string(number.bits);
}

std::string_view to_text(ObjectCode code) {
  switch (code) {
    case ObjectCode::domain_object:
      return "DOMAIN";
    case ObjectCode::variable:
      return "VAR";
    case ObjectCode::array:
      return "ARRAY";
    case ObjectCode::record:
      return "RECORD";
  }
  return "?";
}

std::string_view to_text(Access access) {
  switch (access) {
    case Access::read_only:
      return "ro";
    case Access::read_write:
      return "rw";
    case Access::write_only:
      return "wo";
    case Access::constant:
      return "const";
  }
  return "?";
}

std::string_view to_text(PdoMapping mapping) {
  switch (mapping) {
    case PdoMapping::no:
      return "no";
    case PdoMapping::receive:
      return "rx";
    case PdoMapping::transmit:
      return "tx";
    case PdoMapping::both:
      return "rxtx";
  }
  return "?";
}

std::string default_text(const Entry& entry) {
  const Default& value = entry.declaration().default_value;
  if (is_string(entry.type())) {
    return std::string(value.text);
  }
  if (!value.documented) {
    return {};
  }
  if (entry.declaration().node_id_relative) {
    return "0x" + hexadecimal(value.number.bits, 1) + "+NodeID";
  }
  if (value.number.hexadecimal) {
    return "0x" + hexadecimal(value.number.bits, 2 * byte_length(entry.type()));
  }
  return decimal(entry.type(), value.number);
}

std::string notes_text(const Entry& entry) {
  const EntryDeclaration& declaration = entry.declaration();
  const unsigned offset = static_cast<unsigned>(entry.index()) - declaration.index;
  std::string text;
  if (offset != 0) {
    text = "Motor 0 index " + hexadecimal(declaration.index, 4) + "h + " + hexadecimal(offset, 1) +
           "h.";
    if (!declaration.note.empty()) {
      text += ' ';
    }
  }
  return text += declaration.note;
}

}  // namespace

EntryDescription describe(const Entry& entry) {
  const EntryDeclaration& declaration = entry.declaration();
  EntryDescription description;
  description.index = hexadecimal(entry.index(), 4);
  description.subindex = hexadecimal(entry.subindex(), 2);
  description.name = entry.name();
  description.object_type = to_text(declaration.object_code);
  description.data_type = dictionary::to_text(entry.type());
  description.access = to_text(declaration.access);
  description.pdo_mapping = to_text(declaration.mapping);
  description.default_value = default_text(entry);
  if (declaration.range) {
    description.minimum = decimal(entry.type(), declaration.range->minimum);
    description.maximum = decimal(entry.type(), declaration.range->maximum);
  }
  description.unit = declaration.unit;
  description.source = declaration.source;
  description.notes = notes_text(entry);
  return description;
}

}  // namespace stator::dictionary
