// Elements of an XML device description by their names, whatever prefixes of namespaces these have.
#pragma once

#include <string_view>

#include <pugixml.hpp>

#include "stator/formats/esi/esi_xml.hpp"

namespace stator::formats {

/// The first child with this name, or null.
[[nodiscard]] pugi::xml_node child_named(pugi::xml_node node, std::string_view name);

/// The first element below with this name, in the order of the file, or null.
[[nodiscard]] pugi::xml_node descendant_named(pugi::xml_node node, std::string_view name);

/// The text between an element's tags, without spaces and line ends around it.
[[nodiscard]] std::string_view element_text(pugi::xml_node node);

/// An attribute's value; empty if there is none.
[[nodiscard]] std::string_view xdd_attribute(pugi::xml_node node, const char* name);

}  // namespace stator::formats
