#include "stator/formats/xdd/xdd_elements.hpp"

#include "stator/formats/esi/esi_values.hpp"

namespace stator::formats {

pugi::xml_node child_named(pugi::xml_node node, std::string_view name) {
  return node.find_child([name](pugi::xml_node child) { return local_name(child) == name; });
}

pugi::xml_node descendant_named(pugi::xml_node node, std::string_view name) {
  return node.find_node([name](pugi::xml_node child) { return local_name(child) == name; });
}

std::string_view element_text(pugi::xml_node node) {
  return trimmed(node.text().get());
}

std::string_view xdd_attribute(pugi::xml_node node, const char* name) {
  return node.attribute(name).value();
}

}  // namespace stator::formats
