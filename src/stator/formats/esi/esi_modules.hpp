// Modules of an ESI file and the slots of a device that they stand in (ETG.2000, ETG.5001).
#pragma once

#include <span>
#include <string>
#include <vector>

#include <pugixml.hpp>

#include "stator/base/expected.hpp"
#include "stator/dictionary/import_report.hpp"
#include "stator/formats/esi/esi_slot.hpp"
#include "stator/formats/esi/esi_xml.hpp"

namespace stator::formats {

/// A module in its slot.
struct EsiPlug {
  pugi::xml_node module;  ///< <Module>
  EsiSlot slot;           ///< where it stands
};

/// The modules that stand in a device's slots: those that are `wanted`, by type, name or ident in
/// the order of the slots ("-" leaves one empty), or those that the file has by default. `info` is
/// the element around vendor and descriptions. An error names the modules there are.
[[nodiscard]] base::Expected<std::vector<EsiPlug>, dictionary::ImportError> esi_plugs(
    pugi::xml_node info, pugi::xml_node device, std::span<const std::string> wanted,
    const EsiXml& xml, EsiNotes& notes);

}  // namespace stator::formats
