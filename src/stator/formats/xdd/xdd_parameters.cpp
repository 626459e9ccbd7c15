#include "stator/formats/xdd/xdd_parameters.hpp"

#include <algorithm>
#include <array>

#include "stator/formats/xdd/xdd_elements.hpp"

namespace stator::formats {

namespace {

using canopen::WrittenEntry;
using canopen::WrittenText;

struct TypeName {
  std::string_view name;
  std::uint32_t number;
};

/// Elements that name a type (CiA 311 table 3, after IEC 61131-3), and its number in a dictionary.
constexpr std::array<TypeName, 18> kTypes{{
    {"BOOL", 0x01},
    {"SINT", 0x02},
    {"INT", 0x03},
    {"DINT", 0x04},
    {"USINT", 0x05},
    {"BYTE", 0x05},
    {"UINT", 0x06},
    {"WORD", 0x06},
    {"UDINT", 0x07},
    {"DWORD", 0x07},
    {"REAL", 0x08},
    {"STRING", 0x09},
    {"BITSTRING", 0x0A},
    {"WSTRING", 0x0B},
    {"LREAL", 0x11},
    {"LINT", 0x15},
    {"ULINT", 0x1B},
    {"LWORD", 0x1B},
}};

/// How many names a type may have before it is taken for a circle.
constexpr int kMostReferences = 8;
/// How many elements are looked at for a type; behind labels and descriptions it is the first.
constexpr int kMostElements = 256;

/// Without text there, the text found.
void fill(WrittenText& text, std::string_view found, std::size_t line) {
  if (text.text.empty() && !found.empty()) {
    text = {found, line};
  }
}

}  // namespace

XddParameters::XddParameters(pugi::xml_node root) {
  // find_node() walks through all elements, without calling itself, as none is what it looks for.
  static_cast<void>(root.find_node([this](pugi::xml_node node) {
    if (const std::string_view id = xdd_attribute(node, "uniqueID"); !id.empty()) {
      elements_.try_emplace(id, node);
    }
    return false;
  }));
}

pugi::xml_node XddParameters::find(std::string_view unique_id) const {
  const auto found = elements_.find(unique_id);
  return found != elements_.end() ? found->second : pugi::xml_node();
}

bool XddParameters::complete(WrittenEntry& entry, std::string_view unique_id) const {
  const pugi::xml_node parameter = find(unique_id);
  if (!parameter) {
    return false;
  }
  add(entry, parameter);
  if (const pugi::xml_node common = find(xdd_attribute(parameter, "templateIDRef"))) {
    add(entry, common);
  }
  fill(entry.access, "read", entry.line);  // what the standard's schema has for a missing one
  return true;
}

void XddParameters::add(WrittenEntry& entry, pugi::xml_node parameter) const {
  const auto value_of = [](pugi::xml_node element) { return xdd_attribute(element, "value"); };
  if (!entry.data_type) {
    entry.data_type = type_of(parameter);
  }
  fill(entry.name, element_text(child_named(parameter, "label")), entry.line);
  fill(entry.access, xdd_attribute(parameter, "access"), entry.line);
  fill(entry.default_value, value_of(child_named(parameter, "defaultValue")), entry.line);
  fill(entry.value, value_of(child_named(parameter, "actualValue")), entry.line);
  // Several ranges would be more than one lowest and one highest value.
  const pugi::xml_node allowed = child_named(parameter, "allowedValues");
  const pugi::xml_node range = child_named(allowed, "range");
  const auto is_range = [](pugi::xml_node node) { return local_name(node) == "range"; };
  const auto children = allowed.children();
  if (std::count_if(children.begin(), children.end(), is_range) == 1) {
    fill(entry.low_limit, value_of(child_named(range, "minValue")), entry.line);
    fill(entry.high_limit, value_of(child_named(range, "maxValue")), entry.line);
  }
}

std::optional<std::uint32_t> XddParameters::type_of(pugi::xml_node element) const {
  for (int references = 0; element && references < kMostReferences; ++references) {
    pugi::xml_node next;
    int elements = 0;
    for (const pugi::xml_node child : element.children()) {
      if (++elements > kMostElements) {
        break;
      }
      const auto type = std::ranges::find(kTypes, local_name(child), &TypeName::name);
      if (type != kTypes.end()) {
        return type->number;
      }
      if (local_name(child) == "dataTypeIDRef") {
        next = find(xdd_attribute(child, "uniqueIDRef"));
      }
    }
    element = next;
  }
  return std::nullopt;
}

}  // namespace stator::formats
