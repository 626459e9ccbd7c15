#include "canopen/test_objects.hpp"

namespace stator::canopen::test {

namespace {

using dictionary::Access;
using dictionary::DataType;
using dictionary::EntryDeclaration;
using dictionary::hex;
using dictionary::ObjectCode;
using dictionary::PdoMapping;
using dictionary::Range;
using Objects = std::vector<EntryDeclaration>;

constexpr auto kU8 = DataType::unsigned8;
constexpr auto kU16 = DataType::unsigned16;
constexpr auto kU32 = DataType::unsigned32;
constexpr auto kRo = Access::read_only;
constexpr auto kRw = Access::read_write;

EntryDeclaration entry(std::uint16_t index, std::uint8_t subindex, const char* name, DataType type,
                       Access access, dictionary::Default value = {}) {
  return {.index = index,
          .subindex = subindex,
          .name = name,
          .type = type,
          .access = access,
          .default_value = value};
}

EntryDeclaration count(std::uint16_t index, std::uint8_t highest, Access access = kRo) {
  EntryDeclaration declaration =
      entry(index, 0, "Highest sub-index supported", kU8, access, highest);
  declaration.object_code = ObjectCode::record;
  declaration.object_name = "Record";
  return declaration;
}

/// A COB-ID of the pre-defined connection set; without a CAN-ID it does not count from the node-ID.
EntryDeclaration cob_id(std::uint16_t index, std::uint8_t subindex, const char* name, Access access,
                        std::uint32_t value) {
  EntryDeclaration declaration = entry(index, subindex, name, kU32, access, hex(value));
  declaration.node_id_relative = (value & 0x7FFU) != 0;
  return declaration;
}

EntryDeclaration mapped(EntryDeclaration declaration, PdoMapping mapping) {
  declaration.mapping = mapping;
  return declaration;
}

EntryDeclaration ranged(EntryDeclaration declaration, Range range) {
  declaration.range = range;
  return declaration;
}

void add_array(Objects& objects, std::uint16_t index, const char* name, std::uint8_t highest,
               DataType type, Access access, dictionary::Default value = {}) {
  objects.push_back(count(index, highest));
  for (std::uint8_t subindex = 1; subindex <= highest; ++subindex) {
    objects.push_back(entry(index, subindex, name, type, access, value));
  }
}

void add_communication_objects(Objects& objects) {
  objects.insert(objects.end(),
                 {
                     entry(0x1000, 0, "Device type", kU32, kRo, hex(0x00020192)),
                     entry(0x1001, 0, "Error register", kU8, kRo),
                     entry(0x1005, 0, "COB-ID SYNC", kU32, kRw, hex(0x80)),
                     entry(0x1006, 0, "Communication cycle period", kU32, kRw),
                     entry(0x1007, 0, "Synchronous window length", kU32, kRw),
                     entry(0x1008, 0, "Device name", DataType::visible_string, Access::constant,
                           "Full-featured test device"),
                     entry(0x100C, 0, "Guard time", kU16, kRw),
                     entry(0x100D, 0, "Life time factor", kU8, kRw),
                     entry(0x1012, 0, "COB-ID TIME", kU32, kRw, hex(0x80000100)),
                     cob_id(0x1014, 0, "COB-ID EMCY", kRw, 0x80),
                     entry(0x1015, 0, "Inhibit time EMCY", kU16, kRw),
                     entry(0x1017, 0, "Producer heartbeat time", kU16, kRw),
                     entry(0x1019, 0, "Synchronous counter overflow value", kU8, kRw),
                 });
  objects.push_back(count(0x1003, 0, kRw));
  for (std::uint8_t subindex = 1; subindex <= 4; ++subindex) {
    objects.push_back(entry(0x1003, subindex, "Standard error field", kU32, kRo));
  }
  add_array(objects, 0x1010, "Save parameters", 4, kU32, kRw, 1);
  add_array(objects, 0x1011, "Restore parameters", 4, kU32, kRw, 1);
  add_array(objects, 0x1016, "Consumer heartbeat time", 4, kU32, kRw);
  add_array(objects, 0x1018, "Identity", 4, kU32, kRo, hex(0x286));
  add_array(objects, 0x1020, "Verify configuration", 2, kU32, kRw);
  objects.push_back(count(0x1029, 2));
  objects.push_back(entry(0x1029, 1, "Communication error", kU8, kRw));
  objects.push_back(entry(0x1029, 2, "Application error", kU8, kRw, 1));
  objects.push_back(count(0x1200, 2));
  objects.push_back(cob_id(0x1200, 1, "COB-ID client to server", kRo, 0x600));
  objects.push_back(cob_id(0x1200, 2, "COB-ID server to client", kRo, 0x580));
}

void add_mapping(Objects& objects, std::uint16_t index, std::initializer_list<std::uint32_t> map) {
  objects.push_back(count(index, static_cast<std::uint8_t>(map.size()), kRw));
  for (std::uint8_t subindex = 1; subindex <= kMappingEntries; ++subindex) {
    const std::uint32_t value = subindex <= map.size() ? map.begin()[subindex - 1] : 0;
    objects.push_back(entry(index, subindex, "Mapped object", kU32, kRw, hex(value)));
  }
}

void add_receive_pdo(Objects& objects, unsigned number, std::uint32_t identifier, std::uint8_t type,
                     std::initializer_list<std::uint32_t> map) {
  const auto index = static_cast<std::uint16_t>(0x1400 + number);
  objects.push_back(count(index, 5));
  objects.push_back(cob_id(index, 1, "COB-ID", kRw, identifier));
  objects.push_back(entry(index, 2, "Transmission type", kU8, kRw, type));
  objects.push_back(entry(index, 3, "Inhibit time", kU16, kRw));
  objects.push_back(entry(index, 5, "Event timer", kU16, kRw));
  add_mapping(objects, static_cast<std::uint16_t>(0x1600 + number), map);
}

void add_transmit_pdo(Objects& objects, unsigned number, std::uint32_t identifier,
                      std::uint8_t type, std::initializer_list<std::uint32_t> map) {
  const auto index = static_cast<std::uint16_t>(0x1800 + number);
  objects.push_back(count(index, 6));
  objects.push_back(cob_id(index, 1, "COB-ID", kRw, identifier));
  objects.push_back(entry(index, 2, "Transmission type", kU8, kRw, type));
  objects.push_back(entry(index, 3, "Inhibit time", kU16, kRw));
  objects.push_back(entry(index, 5, "Event timer", kU16, kRw));
  objects.push_back(entry(index, 6, "SYNC start value", kU8, kRw));
  add_mapping(objects, static_cast<std::uint16_t>(0x1A00 + number), map);
}

void add_pdos(Objects& objects) {
  add_receive_pdo(objects, 0, 0x200, 255, {0x20020010});
  add_receive_pdo(objects, 1, 0x300, 254, {0x20010008, 0x20030020});
  add_receive_pdo(objects, 2, 0x400, 1, {0x20020010, 0x20030020});
  add_receive_pdo(objects, 3, 0x500, 255, {});
  add_receive_pdo(objects, 4, 0x80000000, 255, {});
  add_transmit_pdo(objects, 0, 0x180, 255, {0x20110010});
  add_transmit_pdo(objects, 1, 0x280, 254, {0x20100008, 0x20120020});
  add_transmit_pdo(objects, 2, 0x380, 1, {0x20110010, 0x20120020});
  add_transmit_pdo(objects, 3, 0x40000480, 0, {0x20100008});
  add_transmit_pdo(objects, 4, 0x80000000, 255, {});
}

void add_application_objects(Objects& objects) {
  objects.insert(
      objects.end(),
      {
          mapped(entry(0x2001, 0, "Output byte", kU8, kRw), PdoMapping::receive),
          mapped(entry(0x2002, 0, "Output word", kU16, kRw), PdoMapping::receive),
          mapped(entry(0x2003, 0, "Output long", kU32, kRw), PdoMapping::receive),
          mapped(entry(0x2004, 0, "Output that cannot be read", kU32, Access::write_only),
                 PdoMapping::receive),
          mapped(ranged(entry(0x2005, 0, "Percentage", kU8, kRw), {0, 100}), PdoMapping::receive),
          mapped(entry(0x2006, 0, "Signed output", DataType::integer16, kRw), PdoMapping::receive),
          mapped(entry(0x2010, 0, "Input byte", kU8, kRo), PdoMapping::transmit),
          mapped(entry(0x2011, 0, "Input word", kU16, kRo), PdoMapping::transmit),
          mapped(entry(0x2012, 0, "Input long", kU32, kRo), PdoMapping::transmit),
          mapped(entry(0x2013, 0, "Signed input", DataType::integer32, kRo), PdoMapping::transmit),
          entry(0x2020, 0, "Setting", kU32, kRw, 1000),
          ranged(entry(0x2021, 0, "Setting with a range", kU16, kRw, 20), {10, 30}),
          entry(0x2022, 0, "Command", kU32, Access::write_only),
          entry(0x2023, 0, "Text", DataType::visible_string, kRw, "as delivered"),
          entry(0x2024, 0, "Signed setting", DataType::integer16, kRw, -7),
      });
  objects.push_back(count(0x2030, 8));
  for (std::uint8_t subindex = 1; subindex <= 8; ++subindex) {
    objects.push_back(
        mapped(entry(0x2030, subindex, "Output bit", DataType::boolean, kRw), PdoMapping::receive));
  }
  objects.push_back(count(0x2031, 8));
  for (std::uint8_t subindex = 1; subindex <= 8; ++subindex) {
    objects.push_back(
        mapped(entry(0x2031, subindex, "Input bit", DataType::boolean, kRo), PdoMapping::transmit));
  }
}

}  // namespace

Objects full_featured_objects() {
  Objects objects;
  add_communication_objects(objects);
  add_pdos(objects);
  add_application_objects(objects);
  return objects;
}

}  // namespace stator::canopen::test
