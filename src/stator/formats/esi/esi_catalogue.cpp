#include "stator/formats/esi/esi_catalogue.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "stator/formats/esi/esi_values.hpp"

namespace stator::formats {

namespace {

using dictionary::ImportError;
using dictionary::ImportKind;

bool contains_word(std::string_view text, std::string_view word) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == static_cast<unsigned char>(b);
  };
  return std::search(text.begin(), text.end(), word.begin(), word.end(), same) != text.end();
}

/// For whom a profile of ISO 15745 is: its body says so by its type.
std::string_view profile_format(pugi::xml_node root) {
  for (const pugi::xml_node profile : root.children()) {
    for (const pugi::xml_node body : profile.children("ProfileBody")) {
      const std::string_view type = body.attribute("xsi:type").value();
      if (contains_word(type, "powerlink")) {
        return "Ethernet POWERLINK";
      }
      if (contains_word(type, "canopen")) {
        return "CANopen";
      }
    }
  }
  return "CANopen or Ethernet POWERLINK";
}

/// What a file with such a root is, if it is no ESI file.
std::string format_text(pugi::xml_node root) {
  const std::string_view name = root.name();
  if (name == "ISO15745ProfileContainer" || name == "ISO15745Profile") {
    return fmt::format("this is a device description of {} (XDD, XDC), not of EtherCAT",
                       profile_format(root));
  }
  if (name == "EtherCATConfig") {
    return "this is an EtherCAT network information file (ENI), which describes a network; give "
           "the ESI file of a device, or use it as a network";
  }
  if (name == "EtherCATModule" || name == "EtherCATModules") {
    return "this file describes modules only; give the file with the device that they stand in";
  }
  if (name == "EtherCATDict") {
    return "this file describes objects only; give the file with the device that refers to it";
  }
  if (name == "masters") {
    return "this is a configuration of LinuxCNC-EtherCAT, which describes a network; give the ESI "
           "file of a device";
  }
  return fmt::format("the file begins with <{}>; an ESI file begins with <EtherCATInfo>",
                     readable(name));
}

/// The longest known list has a few thousand.
constexpr std::size_t kMostDevices = 65'536;

void add_devices(pugi::xml_node info, const EsiXml& xml, std::vector<EsiCatalogued>& catalogue) {
  for (const pugi::xml_node parent : {info.child("Descriptions"), info}) {
    for (const pugi::xml_node node : parent.child("Devices").children("Device")) {
      if (catalogue.size() > kMostDevices) {
        return;
      }
      const pugi::xml_node type = node.child("Type");
      EsiCatalogued found;
      found.node = node;
      found.info = info;
      found.hidden = esi_truth(attribute_text(node, "Invisible"), false);
      found.device.type = readable(type.child_value());
      found.device.name = esi_name(node);
      found.device.product = esi_identity(attribute_text(type, "ProductCode"));
      found.device.revision = esi_identity(attribute_text(type, "RevisionNo"));
      found.device.line = xml.line_of(node);
      catalogue.push_back(std::move(found));
    }
  }
}

using Candidates = std::vector<const EsiCatalogued*>;

std::string listed(const Candidates& candidates) {
  constexpr std::size_t kMost = 20;
  std::string list;
  for (std::size_t i = 0; i < std::min(kMost, candidates.size()); ++i) {
    const EsiDevice& device = candidates[i]->device;
    list += fmt::format("{}{} (0x{:08X}@0x{:08X})", i == 0 ? "" : ", ",
                        device.type.empty() ? device.name : device.type, device.product,
                        device.revision);
  }
  return candidates.size() > kMost ? fmt::format("{} and {} more", list, candidates.size() - kMost)
                                   : list;
}

Candidates filtered(const Candidates& all,
                    const std::function<bool(const EsiCatalogued&)>& wanted) {
  Candidates result;
  std::ranges::copy_if(all, std::back_inserter(result),
                       [&wanted](const EsiCatalogued* each) { return wanted(*each); });
  return result;
}

/// By type, by name, by either whatever its capitals, by product code: the first that fits any.
Candidates named(const Candidates& all, std::string_view text) {
  const std::optional<EsiNumber> number = esi_number(text);
  for (const std::function<bool(const EsiCatalogued&)>& wanted :
       {std::function<bool(const EsiCatalogued&)>(
            [text](const EsiCatalogued& each) { return each.device.type == text; }),
        std::function<bool(const EsiCatalogued&)>(
            [text](const EsiCatalogued& each) { return each.device.name == text; }),
        std::function<bool(const EsiCatalogued&)>([text](const EsiCatalogued& each) {
          return same_word(each.device.type, text) || same_word(each.device.name, text);
        }),
        std::function<bool(const EsiCatalogued&)>([number](const EsiCatalogued& each) {
          return number && number->bits == each.device.product;
        })}) {
    Candidates found = filtered(all, wanted);
    if (!found.empty()) {
      return found;
    }
  }
  return {};
}

/// Revisions of one device; makers of a few give all their devices one product code.
bool same_product(const EsiDevice& a, const EsiDevice& b) {
  return a.product == b.product && same_word(a.type, b.type);
}

base::Unexpected<ImportError> unknown(std::string_view text, const Candidates& all) {
  return base::Unexpected{
      ImportError{0, "device-unknown",
                  fmt::format("there is no device \"{}\" in the file; there are {}", readable(text),
                              listed(all))}};
}

}  // namespace

std::uint32_t esi_identity(std::string_view text) {
  const std::optional<EsiNumber> number = esi_number(text);
  return number ? static_cast<std::uint32_t>(number->bits) : 0;
}

base::Expected<std::vector<EsiCatalogued>, ImportError> esi_catalogue(const EsiXml& xml) {
  const pugi::xml_node root = xml.root();
  const std::string_view name = root.name();
  std::vector<EsiCatalogued> catalogue;
  if (name == "EtherCATInfoList") {  // several slaves, as the IgH master prints them
    for (const pugi::xml_node info : root.children("EtherCATInfo")) {
      add_devices(info, xml, catalogue);
    }
  } else if (name == "EtherCATInfo") {
    add_devices(root, xml, catalogue);
  } else {
    return base::Unexpected{ImportError{xml.line_of(root), "other-format", format_text(root)}};
  }
  if (catalogue.size() > kMostDevices) {
    return base::Unexpected{
        ImportError{xml.line_of(catalogue.back().node), "too-large",
                    fmt::format("the file has more than {} devices; no maker has", kMostDevices)}};
  }
  if (catalogue.empty()) {
    return base::Unexpected{ImportError{xml.line_of(root), "no-device",
                                        "the file describes no device; one with modules only goes "
                                        "with the file of the device that they stand in"}};
  }
  return catalogue;
}

base::Expected<const EsiCatalogued*, ImportError> esi_chosen(
    const std::vector<EsiCatalogued>& catalogue, std::string_view text, EsiNotes& notes) {
  Candidates all;
  for (const EsiCatalogued& each : catalogue) {
    all.push_back(&each);
  }
  text = trimmed(text);
  Candidates found;
  std::optional<std::uint64_t> revision;
  if (text.empty()) {
    found = filtered(all, [](const EsiCatalogued& each) { return !each.hidden; });
    found = found.empty() ? all : found;
  } else {
    found = named(all, text);
    const std::size_t at = text.rfind('@');
    if (found.empty() && at != std::string_view::npos) {
      revision = esi_number_up_to(text.substr(at + 1), UINT32_MAX);
      found = revision ? named(all, trimmed(text.substr(0, at))) : Candidates();
      found = filtered(
          found, [&](const EsiCatalogued& each) { return each.device.revision == *revision; });
    }
    if (found.empty()) {
      return unknown(text, all);
    }
  }
  const EsiCatalogued* chosen = found.front();
  std::size_t equal = 0;
  std::size_t revisions = 1;
  for (const EsiCatalogued* each : found) {
    if (!same_product(each->device, chosen->device)) {
      return base::Unexpected{ImportError{
          0, "device-ambiguous",
          fmt::format(
              "the file has several devices{}; say which by type, or by product code, \"@\" "
              "and revision: {}",
              text.empty() ? std::string() : fmt::format(" \"{}\"", readable(text)),
              listed(found))}};
    }
    if (each->device.revision > chosen->device.revision) {
      chosen = each;
      equal = 0;
      ++revisions;
    } else if (each->device.revision < chosen->device.revision) {
      ++revisions;
    }
    equal += each->device.revision == chosen->device.revision ? 1U : 0U;
  }
  if (equal > 1) {
    notes.add(
        ImportKind::repaired, chosen->node, "device-twice",
        fmt::format("the file has {} devices of this type and revision; the first counts", equal));
  }
  if (revisions > 1) {
    notes.add(ImportKind::assumed, chosen->node, "revision",
              fmt::format("the file has several revisions; the newest, 0x{:08X}, is taken",
                          chosen->device.revision));
  }
  return chosen;
}

}  // namespace stator::formats
