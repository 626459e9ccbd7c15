// The devices that an ESI file has, and which of them is meant.
#pragma once

#include <string_view>
#include <vector>

#include <pugixml.hpp>

#include "stator/base/expected.hpp"
#include "stator/dictionary/import_report.hpp"
#include "stator/formats/esi/esi_reader.hpp"
#include "stator/formats/esi/esi_xml.hpp"

namespace stator::formats {

/// One <Device> of a file.
struct EsiCatalogued {
  EsiDevice device;     ///< what it is chosen by
  pugi::xml_node node;  ///< its element
  pugi::xml_node info;  ///< the element around vendor and descriptions
  bool hidden = false;  ///< configuration tools do not offer it
};

/// All devices of a file, in its order. An error names the format that the file has instead.
[[nodiscard]] base::Expected<std::vector<EsiCatalogued>, dictionary::ImportError> esi_catalogue(
    const EsiXml& xml);

/// The device that a text means, as EsiChoice::device says. An error names those there are.
[[nodiscard]] base::Expected<const EsiCatalogued*, dictionary::ImportError> esi_chosen(
    const std::vector<EsiCatalogued>& catalogue, std::string_view text, EsiNotes& notes);

/// A number of 32 bits in an attribute; 0 if there is none. Of a longer one the lowest 32 bits
/// count.
[[nodiscard]] std::uint32_t esi_identity(std::string_view text);

}  // namespace stator::formats
