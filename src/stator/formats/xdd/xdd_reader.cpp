#include "stator/formats/xdd/xdd_reader.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "stator/base/spelling.hpp"
#include "stator/canopen/eds/eds_objects.hpp"
#include "stator/canopen/eds/eds_values.hpp"
#include "stator/canopen/eds/import_notes.hpp"
#include "stator/formats/esi/esi_xml.hpp"
#include "stator/formats/xdd/xdd_elements.hpp"
#include "stator/formats/xdd/xdd_parameters.hpp"

namespace stator::formats {

namespace {

using base::same_word;
using canopen::EdsFile;
using canopen::ImportNotes;
using canopen::WrittenEntry;
using canopen::WrittenMapping;
using canopen::WrittenObject;
using canopen::WrittenText;
using dictionary::ImportError;
using dictionary::ImportKind;

/// The file describes a device of Ethernet POWERLINK, in a dialect with the same root.
bool is_powerlink(pugi::xml_node root) {
  const auto says_so = [](std::string_view text) {
    return text.find("owerlink") != std::string_view::npos ||
           text.find("POWERLINK") != std::string_view::npos;
  };
  for (const pugi::xml_attribute attribute : root.attributes()) {
    if (says_so(attribute.value())) {
      return true;
    }
  }
  return static_cast<bool>(root.find_node([&says_so](pugi::xml_node node) {
    const std::string_view name = local_name(node);
    return (name == "ProfileTechnology" && says_so(element_text(node))) ||
           (name == "ProfileBody" && says_so(xdd_attribute(node, "xsi:type")));
  }));
}

ImportError no_objects(const EsiXml& xml) {
  const std::string_view root = local_name(xml.root());
  if (root == "EtherCATInfo" || root == "EtherCATModule") {
    return {1, "not-xdd", "the file is an ESI file of EtherCAT slaves, no XDD (CiA 311)"};
  }
  if (root == "EtherCATConfig") {
    return {1, "not-xdd", "the file is an ENI file of an EtherCAT network, no XDD (CiA 311)"};
  }
  if (root != "ISO15745ProfileContainer") {
    return {1, "not-xdd",
            fmt::format("the file begins with <{}>; an XDD (CiA 311) begins with "
                        "<ISO15745ProfileContainer>",
                        canopen::readable_text(root.substr(0, 40)))};
  }
  return {1, "no-objects",
          "the file has no CANopenObjectList; there is no device to be made of it"};
}

/// "250 Kbps" in bit/s; nothing for "auto-baudRate" and what CAN has not.
std::optional<std::uint32_t> bit_rate_of(std::string_view text) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  const auto number = canopen::parse_eds_number(text.substr(0, digits));
  constexpr std::uint32_t kFastest = 1'000'000;
  if (!number || number->bits == 0 || number->bits > kFastest) {
    return std::nullopt;
  }
  const std::string_view unit = canopen::trimmed(text.substr(digits));
  const auto count = static_cast<std::uint32_t>(number->bits);
  const bool mega = !unit.empty() && base::capital(unit.front()) == 'M';
  const std::uint32_t factor = mega ? 1'000'000 : count > 1000 ? 1 : 1000;
  return count <= kFastest / factor ? std::optional(count * factor) : std::nullopt;
}

/// Puts together what the elements of one file say.
class XddReader {
 public:
  XddReader(const EsiXml& xml, ImportNotes& notes)
      : xml_(xml), notes_(notes), parameters_(xml.root()) {}

  base::Expected<EdsFile, ImportError> read(pugi::xml_node list) {
    for (const pugi::xml_node node : list.children()) {
      if (local_name(node) == "CANopenObject") {
        take_object(node);
      }
    }
    if (values_ > 0) {
      notes_.add(ImportKind::known, 0, "parameter-values",
                 fmt::format("entries that start with their actualValue, not with the default: {}",
                             values_));
    }
    std::vector<WrittenObject> objects;
    objects.reserve(objects_.size());
    for (auto& [index, object] : objects_) {
      objects.push_back(std::move(object));
    }
    auto declarations = canopen::declare_objects(objects, notes_);
    if (!declarations) {
      return base::Unexpected<ImportError>{declarations.error()};
    }
    file_.objects = std::move(*declarations);
    if (file_.objects.rows().empty()) {
      return refusal(xml_.line_of(list), "no-objects",
                     "CANopenObjectList has no object; there is no device to be made of it");
    }
    read_device();
    read_network();
    canopen::complete_identity(file_, notes_);
    return std::move(file_);
  }

 private:
  // Objects.

  void take_object(pugi::xml_node node) {
    const auto index = canopen::parse_hexadecimal(xdd_attribute(node, "index"));
    if (!index || *index > std::numeric_limits<std::uint16_t>::max()) {
      notes_.add(ImportKind::left_out, xml_.line_of(node), "number-unreadable",
                 canopen::quoted(xdd_attribute(node, "index")) + " is no index of an object");
      return;
    }
    const auto [place, added] = objects_.try_emplace(static_cast<std::uint16_t>(*index));
    if (!added) {
      notes_.add(ImportKind::repaired, xml_.line_of(node), "object-repeated",
                 canopen::object_text(place->first) + ": stands here again; the first counts");
      return;
    }
    WrittenObject& object = place->second;
    object.index = place->first;
    object.has_own = true;
    object.own = entry_of(node, 0);
    object.sub_number = number_of(node, "subNumber");
    for (const pugi::xml_node child : node.children()) {
      if (local_name(child) == "CANopenSubObject") {
        take_entry(child, object);
      }
    }
  }

  void take_entry(pugi::xml_node node, WrittenObject& object) {
    const auto subindex = canopen::parse_hexadecimal(xdd_attribute(node, "subIndex"));
    if (!subindex || *subindex > std::numeric_limits<std::uint8_t>::max()) {
      notes_.add(ImportKind::left_out, xml_.line_of(node), "number-unreadable",
                 canopen::object_text(object.index) + ": " +
                     canopen::quoted(xdd_attribute(node, "subIndex")) + " is no subindex");
      return;
    }
    const auto number = static_cast<std::uint8_t>(*subindex);
    if (std::ranges::find(object.entries, number, &WrittenEntry::subindex) !=
        object.entries.end()) {
      notes_.add(
          ImportKind::repaired, xml_.line_of(node), "object-repeated",
          canopen::entry_text(object.index, number) + ": stands here again; the first counts");
      return;
    }
    object.entries.push_back(entry_of(node, number));
  }

  WrittenEntry entry_of(pugi::xml_node node, std::uint8_t subindex) {
    WrittenEntry entry;
    entry.subindex = subindex;
    entry.line = xml_.line_of(node);
    const auto text = [&](const char* name) {
      return WrittenText{canopen::trimmed(xdd_attribute(node, name)), entry.line};
    };
    entry.name = text("name");
    entry.object_type = number_of(node, "objectType");
    entry.data_type = type_of(node);
    entry.access = text("accessType");
    entry.default_value = text("defaultValue");
    entry.value = text("actualValue");
    entry.low_limit = text("lowLimit");
    entry.high_limit = text("highLimit");
    entry.mapping = mapping_of(node);
    if (const WrittenText id = text("uniqueIDRef"); !id.text.empty()) {
      if (!parameters_.complete(entry, id.text)) {
        notes_.add(ImportKind::left_out, entry.line, "parameter-missing",
                   "there is no parameter " + canopen::quoted(id.text));
      }
    }
    values_ += entry.value.text.empty() ? 0 : 1;
    return entry;
  }

  std::optional<std::uint32_t> number_of(pugi::xml_node node, const char* name) {
    const std::string_view text = xdd_attribute(node, name);
    if (text.empty()) {
      return std::nullopt;
    }
    const auto number = canopen::parse_eds_number(text);
    if (!number || number->node_id_relative || number->too_large ||
        number->bits > std::numeric_limits<std::uint32_t>::max()) {
      note_unreadable(node, name);
      return std::nullopt;
    }
    return static_cast<std::uint32_t>(number->bits);
  }

  /// Types are in hexadecimal with or without 0x.
  std::optional<std::uint32_t> type_of(pugi::xml_node node) {
    const std::string_view text = xdd_attribute(node, "dataType");
    const auto type = canopen::parse_hexadecimal(text);
    if (!type && !text.empty()) {
      note_unreadable(node, "dataType");
    }
    return type;
  }

  WrittenMapping mapping_of(pugi::xml_node node) {
    const std::string_view word = canopen::trimmed(xdd_attribute(node, "PDOmapping"));
    if (same_word(word, "default") || same_word(word, "optional")) {
      return WrittenMapping::as_accessed;
    }
    if (same_word(word, "TPDO")) {
      return WrittenMapping::transmit;
    }
    if (same_word(word, "RPDO")) {
      return WrittenMapping::receive;
    }
    const std::optional<bool> flag = canopen::parse_flag(word);
    if (!flag) {
      note_unreadable(node, "PDOmapping");
    }
    return flag.value_or(false) ? WrittenMapping::as_accessed : WrittenMapping::no;
  }

  void note_unreadable(pugi::xml_node node, std::string_view name) {
    const std::string attribute(name);
    notes_.add(ImportKind::repaired, xml_.line_of(node), "number-unreadable",
               canopen::quoted(xdd_attribute(node, attribute.c_str())) + " is no " + attribute +
                   "; it counts as missing");
  }

  // The device.

  void read_device() {
    const pugi::xml_node root = xml_.root();
    const pugi::xml_node device = descendant_named(root, "DeviceIdentity");
    const pugi::xml_node network = descendant_named(root, "identity");
    const auto text = [&](std::string_view name) {
      const std::string_view of_device = element_text(child_named(device, name));
      return of_device.empty() ? element_text(child_named(network, name)) : of_device;
    };
    const auto number = [&](std::string_view name) {
      return canopen::identity_number({text(name), xml_.line_of(device ? device : network)}, name,
                                      notes_);
    };
    file_.vendor_name = canopen::readable_text(text("vendorName"));
    file_.product_name = canopen::readable_text(text("productName"));
    file_.order_code = canopen::readable_text(text("orderNumber"));
    file_.vendor = number("vendorID");
    file_.code = number("productID");
  }

  void read_network() {
    const pugi::xml_node root = xml_.root();
    const pugi::xml_node rates = descendant_named(root, "baudRate");
    for (const pugi::xml_node rate : rates.children()) {
      if (const auto bits = bit_rate_of(xdd_attribute(rate, "value"))) {
        file_.bit_rates.push_back(*bits);
      }
    }
    if (const auto bits = bit_rate_of(xdd_attribute(rates, "defaultValue"))) {
      file_.bit_rates.push_back(*bits);
    }
    std::ranges::sort(file_.bit_rates);
    file_.bit_rates.erase(std::unique(file_.bit_rates.begin(), file_.bit_rates.end()),
                          file_.bit_rates.end());

    const pugi::xml_node features = descendant_named(root, "CANopenGeneralFeatures");
    file_.lss =
        canopen::parse_flag(xdd_attribute(features, "layerSettingServiceSlave")).value_or(false);
    for (const pugi::xml_node dummy : descendant_named(root, "dummyUsage").children()) {
      const std::string_view entry = canopen::trimmed(xdd_attribute(dummy, "entry"));
      file_.dummy_mapping = file_.dummy_mapping || entry.ends_with("=1");
    }

    const pugi::xml_node commissioning = descendant_named(root, "deviceCommissioning");
    file_.bit_rate = bit_rate_of(xdd_attribute(commissioning, "actualBaudRate"));
    if (const auto id = number_of(commissioning, "nodeID")) {
      if (*id >= 1 && *id <= 127) {
        file_.node_id = static_cast<std::uint8_t>(*id);
      } else {
        notes_.add(ImportKind::left_out, xml_.line_of(commissioning), "node-id",
                   fmt::format("{} is no node-ID; those are 1 to 127", *id));
      }
    }
  }

  const EsiXml& xml_;
  ImportNotes& notes_;
  XddParameters parameters_;
  std::map<std::uint16_t, WrittenObject> objects_;
  EdsFile file_;
  std::size_t values_ = 0;
};

}  // namespace

base::Expected<EdsFile, ImportError> read_xdd(std::string_view text,
                                              dictionary::ImportReport& report) {
  if (text.find('<') == std::string_view::npos) {
    return refusal(0, "not-xdd",
                   "the file is no XML; an XDD (CiA 311) begins with <ISO15745ProfileContainer>");
  }
  const auto xml = EsiXml::read(text);
  if (!xml) {
    return base::Unexpected<ImportError>{xml.error()};
  }
  if (is_powerlink(xml->root())) {
    return refusal(1, "powerlink-xdd",
                   "the file describes a device of Ethernet POWERLINK, which has the same root as "
                   "CANopen's XDD; there is no POWERLINK here");
  }
  const pugi::xml_node list = descendant_named(xml->root(), "CANopenObjectList");
  if (!list) {
    return base::Unexpected<ImportError>{no_objects(*xml)};
  }
  report.notes.insert(report.notes.end(), xml->notes().begin(), xml->notes().end());
  ImportNotes notes(report);
  auto file = XddReader(*xml, notes).read(list);
  notes.finish();
  return file;
}

}  // namespace stator::formats
