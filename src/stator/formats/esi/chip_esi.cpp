#include "stator/formats/esi/chip_esi.hpp"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <pugixml.hpp>

namespace stator::formats {

namespace {

std::string hexadecimal(std::uint64_t value, int digits) {
  return fmt::format("#x{:0{}X}", value, digits);
}

std::string hex_bytes(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte b : bytes) {
    text += fmt::format("{:02X}", std::to_integer<unsigned>(b));
  }
  return text;
}

pugi::xml_node add(pugi::xml_node parent, const char* name, const std::string& text) {
  pugi::xml_node node = parent.append_child(name);
  node.append_child(pugi::node_pcdata).set_value(text.c_str());
  return node;
}

/// IEC 61131-3 name of an entry's type by its width.
std::string type_name(unsigned bits) {
  switch (bits) {
    case 8:
      return "USINT";
    case 16:
      return "UINT";
    case 32:
      return "UDINT";
    case 64:
      return "ULINT";
    default:
      return fmt::format("UINT{}", bits);  // UINT24, UINT48 (ETG.1020)
  }
}

void add_pdos(pugi::xml_node device, const char* kind, std::span<const ethercat::SiiPdo> pdos) {
  for (const ethercat::SiiPdo& source : pdos) {
    pugi::xml_node pdo = device.append_child(kind);
    pdo.append_attribute("Fixed") = "1";
    pdo.append_attribute("Mandatory") = "1";
    pdo.append_attribute("Sm") = source.sync_manager;
    add(pdo, "Index", hexadecimal(source.index, 4));
    add(pdo, "Name", source.name);
    for (const ethercat::SiiPdo::Entry& entry : source.entries) {
      pugi::xml_node node = pdo.append_child("Entry");
      add(node, "Index", hexadecimal(entry.index, entry.index == 0 ? 1 : 4));
      if (entry.index != 0) {
        add(node, "SubIndex", std::to_string(entry.subindex));
      }
      add(node, "BitLen", std::to_string(entry.bits));
      if (entry.index != 0) {
        add(node, "Name", entry.name);
        add(node, "DataType", type_name(entry.bits));
      }
    }
  }
}

void add_sync_managers(pugi::xml_node device, const ethercat::SiiContents& contents) {
  for (const std::uint8_t usage : contents.fmmu_usage) {
    add(device, "Fmmu", usage == 1 ? "Outputs" : "Inputs");
  }
  for (const ethercat::SiiSyncManager& manager : contents.sync_managers) {
    pugi::xml_node sm = add(device, "Sm", manager.type == 3 ? "Outputs" : "Inputs");
    sm.append_attribute("DefaultSize") = manager.length;
    sm.append_attribute("StartAddress") = hexadecimal(manager.start, 4).c_str();
    sm.append_attribute("ControlByte") = hexadecimal(manager.control, 2).c_str();
    sm.append_attribute("Enable") = "1";
  }
}

void add_clock_modes(pugi::xml_node device) {
  pugi::xml_node dc = device.append_child("Dc");
  pugi::xml_node mode = dc.append_child("OpMode");
  add(mode, "Name", "Synchron");
  add(mode, "Desc", "Free running");
  add(mode, "AssignActivate", "#x0000");
  mode = dc.append_child("OpMode");
  add(mode, "Name", "DcSync");
  add(mode, "Desc", "SYNC0 once per cycle");
  add(mode, "AssignActivate", "#x0300");
  add(mode, "CycleTimeSync0", "0").append_attribute("Factor") = 1;
  add(mode, "ShiftTimeSync0", "0");
}

void add_eeprom(pugi::xml_node device, const ethercat::SiiContents& contents,
                std::span<const std::byte> image) {
  constexpr std::size_t kConfigDataLength = 14;  // words 0..6, up to the checksum
  pugi::xml_node eeprom = device.append_child("Eeprom");
  add(eeprom, "ByteSize", std::to_string(image.size()));
  add(eeprom, "ConfigData", hex_bytes(image.first(std::min(kConfigDataLength, image.size()))));
  if (!contents.parameter_ram.empty()) {
    pugi::xml_node category = eeprom.append_child("Category");
    add(category, "CatNo", "1");
    add(category, "Data", hex_bytes(contents.parameter_ram));
  }
}

}  // namespace

std::string chip_esi_xml(const ethercat::SiiContents& contents, const std::string& vendor_name,
                         std::span<const std::byte> image) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node root = document.append_child("EtherCATInfo");
  root.append_attribute("xmlns:xsi") = "http://www.w3.org/2001/XMLSchema-instance";
  root.append_attribute("xsi:noNamespaceSchemaLocation") = "EtherCATInfo.xsd";
  root.append_attribute("Version") = "1.6";
  pugi::xml_node vendor = root.append_child("Vendor");
  add(vendor, "Id", hexadecimal(contents.vendor_id, 8));
  add(vendor, "Name", vendor_name);
  pugi::xml_node descriptions = root.append_child("Descriptions");
  pugi::xml_node group = descriptions.append_child("Groups").append_child("Group");
  add(group, "Type", contents.group);
  add(group, "Name", contents.group).append_attribute("LcId") = "1033";

  pugi::xml_node device = descriptions.append_child("Devices").append_child("Device");
  device.append_attribute("Physics") = "YY";
  pugi::xml_node type = add(device, "Type", contents.order_code);
  type.append_attribute("ProductCode") = hexadecimal(contents.product_code, 8).c_str();
  type.append_attribute("RevisionNo") = hexadecimal(contents.revision, 8).c_str();
  add(device, "Name", contents.name).append_attribute("LcId") = "1033";
  add(device, "GroupType", contents.group);
  add_sync_managers(device, contents);
  add_pdos(device, "RxPdo", contents.rx_pdos);
  add_pdos(device, "TxPdo", contents.tx_pdos);
  if (contents.distributed_clocks) {
    add_clock_modes(device);
  }
  add_eeprom(device, contents, image);

  std::ostringstream text;
  document.save(text, "  ", pugi::format_default, pugi::encoding_utf8);
  return text.str();
}

}  // namespace stator::formats
