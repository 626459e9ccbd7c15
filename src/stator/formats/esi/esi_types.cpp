#include "stator/formats/esi/esi_types.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include <fmt/format.h>

#include "stator/formats/esi/esi_values.hpp"

namespace stator::formats {

namespace {

using dictionary::DataType;
using dictionary::ImportKind;

/// Names of types name one another; deeper than this is a circle.
constexpr int kMostAliases = 16;
/// Longest value in bytes: what a segmented SDO of a device of this kind may carry.
constexpr std::size_t kMostBytes = 0xFFFF;

struct Basic {
  std::string_view name;
  DataType type;
};

// ETG.1000.6 table 64 and ETG.2000 annex A, then CiA 301 §7.4.7, then what files write besides.
constexpr std::array kBasics{
    Basic{"BOOL", DataType::boolean},
    Basic{"BIT", DataType::boolean},
    Basic{"BIT1", DataType::boolean},
    Basic{"BIT2", DataType::bit2},
    Basic{"BIT3", DataType::bit3},
    Basic{"BIT4", DataType::bit4},
    Basic{"BIT5", DataType::bit5},
    Basic{"BIT6", DataType::bit6},
    Basic{"BIT7", DataType::bit7},
    Basic{"BIT8", DataType::unsigned8},
    Basic{"BITARR8", DataType::unsigned8},
    Basic{"BITARR16", DataType::unsigned16},
    Basic{"BITARR32", DataType::unsigned32},
    Basic{"BYTE", DataType::unsigned8},
    Basic{"WORD", DataType::unsigned16},
    Basic{"DWORD", DataType::unsigned32},
    Basic{"LWORD", DataType::unsigned64},
    Basic{"SINT", DataType::integer8},
    Basic{"INT", DataType::integer16},
    Basic{"INT24", DataType::integer24},
    Basic{"DINT", DataType::integer32},
    Basic{"INT40", DataType::integer40},
    Basic{"INT48", DataType::integer48},
    Basic{"INT56", DataType::integer56},
    Basic{"LINT", DataType::integer64},
    Basic{"USINT", DataType::unsigned8},
    Basic{"UINT", DataType::unsigned16},
    Basic{"UINT24", DataType::unsigned24},
    Basic{"UDINT", DataType::unsigned32},
    Basic{"UINT40", DataType::unsigned40},
    Basic{"UINT48", DataType::unsigned48},
    Basic{"UINT56", DataType::unsigned56},
    Basic{"ULINT", DataType::unsigned64},
    Basic{"REAL", DataType::real32},
    Basic{"LREAL", DataType::real64},
    Basic{"TIME_OF_DAY", DataType::time_of_day},
    Basic{"TOD", DataType::time_of_day},
    Basic{"TIME_DIFFERENCE", DataType::time_difference},
    Basic{"DOMAIN", DataType::domain},
    Basic{"STRING", DataType::visible_string},
    Basic{"VISIBLE_STRING", DataType::visible_string},
    Basic{"OCTET_STRING", DataType::octet_string},
    Basic{"WSTRING", DataType::unicode_string},
    Basic{"UNICODE_STRING", DataType::unicode_string},
    Basic{"GUID", DataType::octet_string},
    Basic{"BOOLEAN", DataType::boolean},
    Basic{"INTEGER8", DataType::integer8},
    Basic{"INTEGER16", DataType::integer16},
    Basic{"INTEGER24", DataType::integer24},
    Basic{"INTEGER32", DataType::integer32},
    Basic{"INTEGER40", DataType::integer40},
    Basic{"INTEGER48", DataType::integer48},
    Basic{"INTEGER56", DataType::integer56},
    Basic{"INTEGER64", DataType::integer64},
    Basic{"UNSIGNED8", DataType::unsigned8},
    Basic{"UNSIGNED16", DataType::unsigned16},
    Basic{"UNSIGNED24", DataType::unsigned24},
    Basic{"UNSIGNED32", DataType::unsigned32},
    Basic{"UNSIGNED40", DataType::unsigned40},
    Basic{"UNSIGNED48", DataType::unsigned48},
    Basic{"UNSIGNED56", DataType::unsigned56},
    Basic{"UNSIGNED64", DataType::unsigned64},
    Basic{"REAL32", DataType::real32},
    Basic{"REAL64", DataType::real64},
    Basic{"INT8", DataType::integer8},
    Basic{"INT16", DataType::integer16},
    Basic{"INT32", DataType::integer32},
    Basic{"INT64", DataType::integer64},
    Basic{"UINT8", DataType::unsigned8},
    Basic{"UINT16", DataType::unsigned16},
    Basic{"UINT32", DataType::unsigned32},
    Basic{"UINT64", DataType::unsigned64},
    Basic{"FLOAT", DataType::real32},
    Basic{"DOUBLE", DataType::real64},
};

std::optional<DataType> basic(std::string_view name) {
  const auto* const found = std::ranges::find_if(
      kBasics, [name](const Basic& each) { return same_word(each.name, name); });
  return found == kBasics.end() ? std::nullopt : std::optional(found->type);
}

/// "ARRAY [0..7] OF BYTE".
std::optional<EsiType> array_of_basic(std::string_view name) {
  constexpr std::string_view kArray = "ARRAY";
  if (!same_word(name.substr(0, kArray.size()), kArray)) {
    return std::nullopt;
  }
  const std::size_t open = name.find('[');
  const std::size_t dots = name.find("..", open == std::string_view::npos ? 0 : open);
  const std::size_t close = name.find(']', dots == std::string_view::npos ? 0 : dots);
  if (open == std::string_view::npos || dots == std::string_view::npos ||
      close == std::string_view::npos) {
    return std::nullopt;
  }
  const auto first = esi_number_up_to(name.substr(open + 1, dots - open - 1), kMostBytes);
  const auto last = esi_number_up_to(name.substr(dots + 2, close - dots - 2), kMostBytes);
  std::string_view element = trimmed(name.substr(close + 1));
  if (!first || !last || *last < *first || !same_word(element.substr(0, 2), "OF")) {
    return std::nullopt;
  }
  const std::optional<DataType> type = basic(trimmed(element.substr(2)));
  if (!type || is_string(*type)) {
    return std::nullopt;
  }
  return EsiType{DataType::octet_string, (*last - *first + 1) * bit_length(*type)};
}

/// "STRING(20)".
std::optional<EsiType> sized_string(std::string_view name) {
  const std::size_t open = name.find_first_of("([");
  if (open == std::string_view::npos || (name.back() != ')' && name.back() != ']')) {
    return std::nullopt;
  }
  const std::optional<DataType> type = basic(trimmed(name.substr(0, open)));
  const auto length = esi_number_up_to(name.substr(open + 1, name.size() - open - 2), kMostBytes);
  if (!type || !is_string(*type) || !length) {
    return std::nullopt;
  }
  const std::size_t character = *type == DataType::unicode_string ? 16 : 8;
  return EsiType{*type, *length * character};
}

/// Whether an enumeration has a value below 0; of very long ones only the beginning is looked at.
bool has_negative(pugi::xml_node type) {
  int seen = 0;
  for (const pugi::xml_node info : type.children("EnumInfo")) {
    if (child_text(info, "Enum").starts_with('-')) {
      return true;
    }
    constexpr int kMost = 1000;
    if (++seen == kMost) {
      break;
    }
  }
  return false;
}

}  // namespace

std::optional<EsiType> esi_basic_type(std::string_view name) {
  name = trimmed(name);
  if (name.empty()) {
    return std::nullopt;
  }
  if (const std::optional<DataType> type = basic(name)) {
    constexpr std::size_t kGuidBits = 128;
    return EsiType{*type, same_word(name, "GUID") ? kGuidBits : bit_length(*type)};
  }
  const std::optional<EsiType> array = array_of_basic(name);
  return array ? array : sized_string(name);
}

DataType esi_type_of_bits(std::size_t bits, bool is_signed) {
  switch (bits) {
    case 1:
      return DataType::boolean;
    case 2:
      return DataType::bit2;
    case 3:
      return DataType::bit3;
    case 4:
      return DataType::bit4;
    case 5:
      return DataType::bit5;
    case 6:
      return DataType::bit6;
    case 7:
      return DataType::bit7;
    default:
      break;
  }
  constexpr std::array kUnsigned{DataType::unsigned8,  DataType::unsigned16, DataType::unsigned24,
                                 DataType::unsigned32, DataType::unsigned40, DataType::unsigned48,
                                 DataType::unsigned56, DataType::unsigned64};
  constexpr std::array kSigned{DataType::integer8,  DataType::integer16, DataType::integer24,
                               DataType::integer32, DataType::integer40, DataType::integer48,
                               DataType::integer56, DataType::integer64};
  const std::size_t bytes = (bits + 7) / 8;
  if (bytes == 0 || bytes > kUnsigned.size()) {
    return DataType::octet_string;
  }
  return is_signed ? kSigned[bytes - 1] : kUnsigned[bytes - 1];
}

std::size_t esi_bits(std::string_view text) {
  return esi_number_up_to(text, kMostBytes * 8).value_or(0);
}

void EsiTypes::add(pugi::xml_node data_types) {
  for (const pugi::xml_node node : data_types.children("DataType")) {
    const std::string_view name = child_text(node, "Name");
    Declared type;
    type.node = node;
    type.bits = esi_bits(child_text(node, "BitSize"));
    type.base = child_text(node, "BaseType");
    type.record = !node.child("SubItem").empty();
    type.enumerated = !node.child("EnumInfo").empty();
    type.negative = has_negative(node);
    if (const pugi::xml_node array = node.child("ArrayInfo")) {
      type.array = true;
      type.first_element = esi_number_up_to(child_text(array, "LBound"), kMostBytes).value_or(0);
      type.elements = esi_number_up_to(child_text(array, "Elements"), kMostBytes).value_or(1);
    }
    const auto [found, taken] = types_.emplace(name, type);
    if (!taken && found->second.bits != type.bits) {
      notes_->add(ImportKind::repaired, node, "type-twice",
                  fmt::format("the data type {} is declared again, with {} instead of {} bits; the "
                              "first counts",
                              readable(name), type.bits, found->second.bits));
    }
  }
}

const EsiTypes::Declared* EsiTypes::find(std::string_view name) const {
  for (const EsiTypes* types = this; types != nullptr; types = types->outer_) {
    if (const auto found = types->types_.find(trimmed(name)); found != types->types_.end()) {
      return &found->second;
    }
  }
  return nullptr;
}

pugi::xml_node EsiTypes::structure(std::string_view name) const {
  for (int i = 0; i < kMostAliases && !esi_basic_type(name); ++i) {
    const Declared* const type = find(name);
    if (type == nullptr) {
      return {};
    }
    if (type->record) {
      return type->node;
    }
    if (type->array) {
      const std::optional<EsiType> element = known(type->base, 0);
      const bool bytes = type->first_element == 0 && element && element->bits <= 8;
      return bytes ? pugi::xml_node() : type->node;
    }
    name = type->base;
  }
  return {};
}

pugi::xml_node EsiTypes::enumeration(std::string_view name) const {
  for (int i = 0; i < kMostAliases && !name.empty(); ++i) {
    const Declared* const type = find(name);
    if (type == nullptr) {
      return {};
    }
    if (type->enumerated) {
      return type->node;
    }
    name = type->base;
  }
  return {};
}

std::optional<EsiType> EsiTypes::known(std::string_view name, std::size_t bits) const {
  if (name.empty()) {
    return std::nullopt;
  }
  std::size_t size = 0;  // by the outermost alias that says it
  std::size_t elements = 1;
  bool array = false;
  for (int i = 0; i < kMostAliases; ++i) {
    if (std::optional<EsiType> basic_type = esi_basic_type(name)) {
      if (array) {
        return EsiType{DataType::octet_string,
                       std::min(elements * basic_type->bits, kMostBytes * 8)};
      }
      if (is_string(basic_type->type)) {
        if (basic_type->bits == 0 && name.find_first_of("([") == std::string_view::npos) {
          basic_type->bits = size != 0 ? size : bits;
        }
      } else if (size != 0 && size != basic_type->bits) {
        return EsiType{esi_type_of_bits(size, is_signed(basic_type->type)), size};
      }
      return basic_type;
    }
    const Declared* const type = find(name);
    if (type == nullptr) {
      return std::nullopt;
    }
    size = size != 0 ? size : type->bits;
    if (type->record || (type->array && type->bits != 0)) {
      return EsiType{DataType::octet_string, size};
    }
    if (type->array) {
      array = true;
      elements = type->elements;
    }
    if (type->base.empty()) {
      size = size != 0 ? size : bits;
      return size == 0 ? std::nullopt
                       : std::optional(EsiType{esi_type_of_bits(size, type->negative), size});
    }
    name = type->base;
  }
  return std::nullopt;
}

EsiType EsiTypes::resolve(std::string_view name, std::size_t bits, pugi::xml_node at) const {
  if (const std::optional<EsiType> type = known(name, bits)) {
    return *type;
  }
  constexpr std::size_t kUsualBits = 32;
  const std::size_t length = bits != 0 ? bits : kUsualBits;
  const DataType type = esi_type_of_bits(length, false);
  notes_->add(
      ImportKind::assumed, at, "type-unknown",
      name.empty()
          ? fmt::format("there is no data type here; {} is taken", to_text(type).view())
          : fmt::format("the data type {} is declared nowhere; by its length of {} bits, {} "
                        "is taken",
                        readable(name), length, to_text(type).view()));
  return {type, length};
}

}  // namespace stator::formats
