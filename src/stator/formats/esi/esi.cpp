#include "stator/formats/esi/esi.hpp"

#include <algorithm>
#include <sstream>
#include <string_view>

#include <fmt/format.h>
#include <pugixml.hpp>

namespace stator::formats {

namespace {

using dictionary::Access;
using dictionary::DataType;
using dictionary::Dictionary;
using dictionary::Entry;
using dictionary::Object;
using dictionary::PdoMapping;

std::string hexadecimal(std::uint64_t value, int digits) {
  return fmt::format("#x{:0{}X}", value, digits);
}

void add(pugi::xml_node parent, const char* name, const std::string& text) {
  parent.append_child(name).append_child(pugi::node_pcdata).set_value(text.c_str());
}

/// IEC 61131-3 name of a basic type, as ESI files use it (ETG.2000 annex).
std::string type_name(const Entry& entry) {
  switch (entry.type()) {
    case DataType::boolean:
      return "BOOL";
    case DataType::integer8:
      return "SINT";
    case DataType::integer16:
      return "INT";
    case DataType::integer32:
      return "DINT";
    case DataType::integer64:
      return "LINT";
    case DataType::unsigned8:
      return "USINT";
    case DataType::unsigned16:
      return "UINT";
    case DataType::unsigned32:
      return "UDINT";
    case DataType::unsigned64:
      return "ULINT";
    case DataType::integer24:
      return "INT24";
    case DataType::integer40:
      return "INT40";
    case DataType::integer48:
      return "INT48";
    case DataType::integer56:
      return "INT56";
    case DataType::unsigned24:
      return "UINT24";
    case DataType::unsigned40:
      return "UINT40";
    case DataType::unsigned48:
      return "UINT48";
    case DataType::unsigned56:
      return "UINT56";
    case DataType::bit2:
      return "BIT2";
    case DataType::bit3:
      return "BIT3";
    case DataType::bit4:
      return "BIT4";
    case DataType::bit5:
      return "BIT5";
    case DataType::bit6:
      return "BIT6";
    case DataType::bit7:
      return "BIT7";
    case DataType::time_of_day:
    case DataType::time_difference:
      return "ARRAY [0..5] OF BYTE";
    case DataType::real32:
      return "REAL";
    case DataType::real64:
      return "LREAL";
    case DataType::visible_string:
      return fmt::format("STRING({})", entry.text().size());
    case DataType::octet_string:
    case DataType::unicode_string:
    case DataType::domain:
      return fmt::format("ARRAY [0..{}] OF BYTE",
                         entry.text().empty() ? 0 : entry.text().size() - 1);
  }
  return "";
}

std::string object_type_name(const Object& object) {
  return object.single() ? type_name(object.entries.front())
                         : fmt::format("DT{:04X}", object.index);
}

const char* access_text(const Entry& entry) {
  switch (entry.declaration().access) {
    case Access::read_write:
      return "rw";
    case Access::write_only:
      return "wo";
    case Access::read_only:
    case Access::constant:
      return "ro";
  }
  return "ro";
}

void add_flags(pugi::xml_node parent, const Entry& entry) {
  pugi::xml_node flags = parent.append_child("Flags");
  pugi::xml_node access = flags.append_child("Access");
  access.append_child(pugi::node_pcdata).set_value(access_text(entry));
  if (entry.writable() && entry.declaration().write_states == dictionary::kPreOperationalOnly) {
    access.append_attribute("WriteRestrictions") = "PreOP";
  }
  switch (entry.declaration().mapping) {
    case PdoMapping::receive:
      add(flags, "PdoMapping", "R");
      break;
    case PdoMapping::transmit:
      add(flags, "PdoMapping", "T");
      break;
    case PdoMapping::both:
      add(flags, "PdoMapping", "RT");
      break;
    case PdoMapping::no:
      break;
  }
}

/// Values in ESI files are little-endian byte strings in hexadecimal.
std::string value_text(const Entry& entry, std::uint64_t bits) {
  std::string text;
  for (std::size_t i = 0; i < entry.size(); ++i) {
    text += fmt::format("{:02X}", (bits >> (8 * i)) & 0xFF);
  }
  return text;
}

std::string default_text(const Entry& entry) {
  if (!is_string(entry.type())) {
    return value_text(entry, entry.default_bits());
  }
  std::string text;
  for (const char c : entry.declaration().default_value.text) {
    text += fmt::format("{:02X}", static_cast<unsigned char>(c));
  }
  return text;
}

/// Bit offset of a sub-index within its object: sub-index 0 takes 16 bits (ETG.1000.6 §5.6.2.6).
class OffsetCounter {
 public:
  std::size_t place(const Entry& entry) {
    if (entry.subindex() == 0) {
      next_ = 16;
      return 0;
    }
    const std::size_t offset = next_;
    next_ += entry.bits();
    return offset;
  }
  [[nodiscard]] std::size_t total() const { return next_; }

 private:
  std::size_t next_ = 0;
};

std::size_t object_bits(const Object& object) {
  if (object.single()) {
    return object.entries.front().bits();
  }
  OffsetCounter offsets;
  for (const Entry& entry : object.entries) {
    offsets.place(entry);
  }
  return offsets.total();
}

void add_data_types(pugi::xml_node types, const Dictionary& dictionary) {
  std::vector<std::string> basic;
  for (const Entry& entry : dictionary.entries()) {
    const std::string name = type_name(entry);
    if (std::ranges::find(basic, name) == basic.end()) {
      basic.push_back(name);
      pugi::xml_node type = types.append_child("DataType");
      add(type, "Name", name);
      add(type, "BitSize", std::to_string(entry.bits()));
    }
  }
  for (const Object& object : dictionary.objects()) {
    if (object.single()) {
      continue;
    }
    pugi::xml_node type = types.append_child("DataType");
    add(type, "Name", object_type_name(object));
    add(type, "BitSize", std::to_string(object_bits(object)));
    OffsetCounter offsets;
    for (const Entry& entry : object.entries) {
      pugi::xml_node item = type.append_child("SubItem");
      add(item, "SubIdx", std::to_string(entry.subindex()));
      add(item, "Name", entry.name());
      add(item, "Type", type_name(entry));
      add(item, "BitSize", std::to_string(entry.bits()));
      add(item, "BitOffs", std::to_string(offsets.place(entry)));
      add_flags(item, entry);
    }
  }
}

void add_default(pugi::xml_node info, const Entry& entry) {
  if (entry.declaration().range && !is_string(entry.type())) {
    add(info, "MinData", value_text(entry, entry.declaration().range->minimum.bits));
    add(info, "MaxData", value_text(entry, entry.declaration().range->maximum.bits));
  }
  add(info, "DefaultData", default_text(entry));
}

void add_objects(pugi::xml_node objects, const Dictionary& dictionary) {
  for (const Object& object : dictionary.objects()) {
    pugi::xml_node node = objects.append_child("Object");
    add(node, "Index", hexadecimal(object.index, 4));
    add(node, "Name", object.name.str());
    add(node, "Type", object_type_name(object));
    add(node, "BitSize", std::to_string(object_bits(object)));
    pugi::xml_node info = node.append_child("Info");
    if (object.single()) {
      add_default(info, object.entries.front());
      add_flags(node, object.entries.front());
      continue;
    }
    for (const Entry& entry : object.entries) {
      pugi::xml_node item = info.append_child("SubItem");
      add(item, "Name", entry.name());
      add_default(item.append_child("Info"), entry);
    }
    add_flags(node, object.entries.front());
  }
}

void add_pdo(pugi::xml_node device, const Dictionary& dictionary, const Object& mapping,
             bool receive, bool assigned) {
  pugi::xml_node pdo = device.append_child(receive ? "RxPdo" : "TxPdo");
  if (assigned) {
    pdo.append_attribute("Sm") = receive ? 2 : 3;
  }
  add(pdo, "Index", hexadecimal(mapping.index, 4));
  add(pdo, "Name", mapping.name.str());
  const std::uint64_t count = mapping.entries.front().default_bits();
  for (const Entry& slot : mapping.entries) {
    if (slot.subindex() == 0 || slot.subindex() > count) {
      continue;
    }
    const std::uint64_t bits = slot.default_bits();
    const auto index = static_cast<std::uint16_t>(bits >> 16);
    const auto subindex = static_cast<std::uint8_t>(bits >> 8);
    pugi::xml_node entry = pdo.append_child("Entry");
    add(entry, "Index", hexadecimal(index, 4));
    add(entry, "SubIndex", std::to_string(subindex));
    add(entry, "BitLen", std::to_string(bits & 0xFF));
    if (const Entry* mapped = dictionary.find(index, subindex); mapped != nullptr) {
      add(entry, "Name", mapped->name());
      add(entry, "DataType", type_name(*mapped));
    }
  }
}

void add_pdos(pugi::xml_node device, const Dictionary& dictionary) {
  for (const bool receive : {true, false}) {
    const std::uint16_t first = receive ? 0x1600 : 0x1A00;
    const Object* assignment = dictionary.find(receive ? 0x1C12 : 0x1C13);
    for (const Object& object : dictionary.objects()) {
      if (object.index < first || object.index >= first + 0x200) {
        continue;
      }
      const bool assigned =
          assignment != nullptr && std::ranges::any_of(assignment->entries, [&](const Entry& e) {
            return e.subindex() != 0 && e.default_bits() == object.index;
          });
      add_pdo(device, dictionary, object, receive, assigned);
    }
  }
}

std::size_t default_pdo_bytes(const Dictionary& dictionary, bool receive) {
  const Object* mapping = dictionary.find(receive ? 0x1600 : 0x1A00);
  std::uint64_t bits = 0;
  if (mapping != nullptr) {
    for (const Entry& slot : mapping->entries) {
      if (slot.subindex() != 0 && slot.subindex() <= mapping->entries.front().default_bits()) {
        bits += slot.default_bits() & 0xFF;
      }
    }
  }
  return static_cast<std::size_t>((bits + 7) / 8);
}

void add_sync_manager(pugi::xml_node device, const char* use, std::size_t size, std::uint16_t start,
                      std::uint8_t control) {
  pugi::xml_node sm = device.append_child("Sm");
  sm.append_attribute("DefaultSize") = std::to_string(size).c_str();
  sm.append_attribute("StartAddress") = hexadecimal(start, 4).c_str();
  sm.append_attribute("ControlByte") = hexadecimal(control, 2).c_str();
  sm.append_attribute("Enable") = "1";
  sm.append_child(pugi::node_pcdata).set_value(use);
}

void add_process_data_interfaces(pugi::xml_node device,
                                 const ethercat::DeviceDescription& description,
                                 const Dictionary& dictionary) {
  for (const char* use : {"Outputs", "Inputs", "MBoxState"}) {
    add(device, "Fmmu", use);
  }
  // Control bytes as masters write them: 26h mailbox out, 22h mailbox in, 64h three-buffer outputs
  // with watchdog, 20h three-buffer inputs (ETG.1000.4 §6.6).
  add_sync_manager(device, "MBoxOut", description.receive_mailbox.length,
                   description.receive_mailbox.offset, 0x26);
  add_sync_manager(device, "MBoxIn", description.transmit_mailbox.length,
                   description.transmit_mailbox.offset, 0x22);
  add_sync_manager(device, "Outputs", default_pdo_bytes(dictionary, true),
                   description.output_offset, 0x64);
  add_sync_manager(device, "Inputs", default_pdo_bytes(dictionary, false), description.input_offset,
                   0x20);
}

void add_mailbox(pugi::xml_node device, const ethercat::DeviceDescription& description) {
  pugi::xml_node mailbox = device.append_child("Mailbox");
  mailbox.append_attribute("DataLinkLayer") = "1";
  if (description.coe) {
    pugi::xml_node coe = mailbox.append_child("CoE");
    coe.append_attribute("SdoInfo") = description.sdo_information ? "1" : "0";
    coe.append_attribute("SegmentedSdo") = "1";
    coe.append_attribute("CompleteAccess") = description.complete_access ? "1" : "0";
    coe.append_attribute("PdoAssign") = description.pdo_assign ? "1" : "0";
    coe.append_attribute("PdoConfig") = description.pdo_configuration ? "1" : "0";
  }
  if (description.eoe) {
    mailbox.append_child("EoE");
  }
  if (description.foe) {
    mailbox.append_child("FoE");
  }
}

std::string mailbox_words(const ethercat::MailboxArea& receive,
                          const ethercat::MailboxArea& transmit) {
  std::string text;
  for (const std::uint16_t word :
       {receive.offset, receive.length, transmit.offset, transmit.length}) {
    text += fmt::format("{:02X}{:02X}", word & 0xFF, word >> 8);
  }
  return text;
}

void add_eeprom(pugi::xml_node device, const ethercat::DeviceDescription& description,
                std::span<const std::byte> sii) {
  pugi::xml_node eeprom = device.append_child("Eeprom");
  add(eeprom, "ByteSize", std::to_string(sii.size()));
  constexpr std::size_t kConfigDataLength = 14;  // words 0..6, up to the checksum
  std::string config;
  for (const std::byte b : sii.first(std::min(kConfigDataLength, sii.size()))) {
    config += fmt::format("{:02X}", std::to_integer<unsigned>(b));
  }
  add(eeprom, "ConfigData", config);
  if (description.bootstrap_receive_mailbox.length != 0) {
    add(eeprom, "BootStrap",
        mailbox_words(description.bootstrap_receive_mailbox,
                      description.bootstrap_transmit_mailbox));
  }
}

void add_profile(pugi::xml_node device, const Dictionary& dictionary) {
  pugi::xml_node profile = device.append_child("Profile");
  if (const Entry* device_type = dictionary.find(0x1000, 0); device_type != nullptr) {
    add(profile, "ProfileNo", std::to_string(device_type->default_bits() & 0xFFFF));
    add(profile, "AddInfo", std::to_string((device_type->default_bits() >> 16) & 0xFFFF));
  }
  pugi::xml_node content = profile.append_child("Dictionary");
  add_data_types(content.append_child("DataTypes"), dictionary);
  add_objects(content.append_child("Objects"), dictionary);
}

void add_device(pugi::xml_node devices, const ethercat::DeviceDescription& description,
                const Dictionary& dictionary, std::span<const std::byte> sii) {
  pugi::xml_node device = devices.append_child("Device");
  std::string physics(description.port_physics.begin(), description.port_physics.end());
  physics.erase(physics.find_last_not_of(' ') + 1);
  device.append_attribute("Physics") = physics.c_str();

  pugi::xml_node type = device.append_child("Type");
  type.append_attribute("ProductCode") = hexadecimal(description.product_code, 8).c_str();
  type.append_attribute("RevisionNo") = hexadecimal(description.revision, 8).c_str();
  type.append_child(pugi::node_pcdata).set_value(description.order_code.c_str());

  pugi::xml_node name = device.append_child("Name");
  name.append_attribute("LcId") = "1033";
  name.append_child(pugi::node_pcdata).set_value(description.name.c_str());
  add(device, "GroupType", description.group);

  if (description.coe) {
    add_profile(device, dictionary);
  }
  if (description.exchanges_data()) {
    add_process_data_interfaces(device, description, dictionary);
  }
  add_pdos(device, dictionary);
  if (description.receive_mailbox.length != 0) {
    add_mailbox(device, description);
  }
  if (description.distributed_clocks) {
    pugi::xml_node mode = device.append_child("Dc").append_child("OpMode");
    add(mode, "Name", "SM_Sync");
    add(mode, "Desc", "Synchronised with the process data");
    add(mode, "AssignActivate", "#x0000");
    mode = device.child("Dc").append_child("OpMode");
    add(mode, "Name", "DC_Sync0");
    add(mode, "Desc", "Synchronised with SYNC0");
    add(mode, "AssignActivate", "#x0300");
    // Once per cycle of the master, in phase with it.
    add(mode, "CycleTimeSync0", "0");
    mode.child("CycleTimeSync0").append_attribute("Factor") = 1;
    add(mode, "ShiftTimeSync0", "0");
  }
  add_eeprom(device, description, sii);
}

}  // namespace

std::string esi_xml(const ethercat::DeviceDescription& description,
                    const dictionary::Dictionary& dictionary, std::span<const std::byte> sii) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";

  pugi::xml_node root = document.append_child("EtherCATInfo");
  root.append_attribute("xmlns:xsi") = "http://www.w3.org/2001/XMLSchema-instance";
  root.append_attribute("xsi:noNamespaceSchemaLocation") = "EtherCATInfo.xsd";
  root.append_attribute("Version") = "1.6";

  pugi::xml_node vendor = root.append_child("Vendor");
  add(vendor, "Id", hexadecimal(description.vendor_id, 8));
  add(vendor, "Name", description.vendor_name);

  pugi::xml_node descriptions = root.append_child("Descriptions");
  pugi::xml_node group = descriptions.append_child("Groups").append_child("Group");
  add(group, "Type", description.group);
  pugi::xml_node group_name = group.append_child("Name");
  group_name.append_attribute("LcId") = "1033";
  group_name.append_child(pugi::node_pcdata).set_value(description.group.c_str());

  add_device(descriptions.append_child("Devices"), description, dictionary, sii);

  std::ostringstream text;
  document.save(text, "  ", pugi::format_default, pugi::encoding_utf8);
  return text.str();
}

}  // namespace stator::formats
