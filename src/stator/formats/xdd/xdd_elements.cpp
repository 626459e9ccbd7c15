#include "stator/formats/xdd/xdd_elements.hpp"

namespace stator::formats {

pugi::xml_node child_named(pugi::xml_node node, std::string_view name) {
  return node.find_child([name](pugi::xml_node child) { return local_name(child) == name; });
}

pugi::xml_node descendant_named(pugi::xml_node node, std::string_view name) {
  return node.find_node([name](pugi::xml_node child) { return local_name(child) == name; });
}

std::string_view element_text(pugi::xml_node node) {
  constexpr std::string_view kSpaces = " \t\r\n";
  const std::string_view text = node.text().get();
  const std::size_t begin = text.find_first_not_of(kSpaces);
  if (begin == std::string_view::npos) {
    return {};
  }
  return text.substr(begin, text.find_last_not_of(kSpaces) + 1 - begin);
}

std::string_view xdd_attribute(pugi::xml_node node, const char* name) {
  return node.attribute(name).value();
}

}  // namespace stator::formats
