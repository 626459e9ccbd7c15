#include "stator/formats/esi/esi_dictionary.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "stator/formats/esi/esi_value_text.hpp"
#include "stator/formats/esi/esi_values.hpp"

namespace stator::formats {

namespace {

using dictionary::Access;
using dictionary::DataType;
using dictionary::EntryDeclaration;
using dictionary::ImportKind;
using dictionary::NetworkState;
using dictionary::ObjectCode;
using dictionary::PdoMapping;

constexpr std::size_t kMostRows = 65'536;

std::string subindex_name(std::size_t subindex) {
  return fmt::format("SubIndex {:03}", subindex);
}

/// Arrays by CiA 301 and ETG.1000.6, for files whose types tell every element.
bool is_standard_array(std::uint16_t index) {
  return index == 0x1003 || index == 0x1010 || index == 0x1011 ||
         (index >= 0x1C00 && index < 0x1C30);
}

/// "PreOP_SafeOP" as bits of NetworkState; all states if it names none.
std::uint8_t states_of(std::string_view text) {
  unsigned states = 0;
  while (!text.empty()) {
    const auto is_word = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
    const auto end = std::ranges::find_if_not(text, is_word);
    const std::string_view word = text.substr(0, static_cast<std::size_t>(end - text.begin()));
    if (same_word(word, "PreOP")) {
      states |= static_cast<unsigned>(NetworkState::pre_operational);
    } else if (same_word(word, "SafeOP")) {
      states |= static_cast<unsigned>(NetworkState::safe_operational);
    } else if (same_word(word, "OP")) {
      states |= static_cast<unsigned>(NetworkState::operational);
    }
    text.remove_prefix(std::min(word.size() + 1, text.size()));
  }
  return states == 0 ? dictionary::kAllNetworkStates : static_cast<std::uint8_t>(states);
}

std::optional<Access> access_of(std::string_view text) {
  constexpr std::pair<std::string_view, Access> kAccesses[] = {
      {"ro", Access::read_only},   {"rw", Access::read_write},  {"wo", Access::write_only},
      {"const", Access::constant}, {"rwr", Access::read_write}, {"rww", Access::read_write},
      {"r", Access::read_only},    {"w", Access::write_only}};
  for (const auto& [name, access] : kAccesses) {
    if (same_word(text, name)) {
      return access;
    }
  }
  return std::nullopt;
}

PdoMapping mapping_of(std::string_view text) {
  const bool receive = text.find_first_of("Rr") != std::string_view::npos;
  const bool transmit = text.find_first_of("Tt") != std::string_view::npos;
  return receive && transmit ? PdoMapping::both
         : receive           ? PdoMapping::receive
         : transmit          ? PdoMapping::transmit
                             : PdoMapping::no;
}

/// Whether a <SubItem> of a type has values in it, which most have in an <Info>, or not at all.
bool has_values(pugi::xml_node declared) {
  constexpr std::array kNames{"DefaultData", "DefaultValue", "DefaultString", "MinData",
                              "MinValue",    "MaxData",      "MaxValue"};
  return std::ranges::any_of(
      kNames, [declared](const char* name) { return !declared.child(name).empty(); });
}

}  // namespace

void EsiDictionary::add(pugi::xml_node objects, const EsiTypes& types, const EsiSlot& slot) {
  for (const pugi::xml_node object : objects.children("Object")) {
    if (full_) {
      return;
    }
    add_object(object, types, slot);
  }
}

EntryDeclaration* EsiDictionary::find(std::uint16_t index, std::uint8_t subindex) {
  const auto held = held_.find(index);
  if (held == held_.end()) {
    return nullptr;
  }
  const auto row = std::ranges::find(held->second.rows, subindex, &EntryDeclaration::subindex);
  return row == held->second.rows.end() ? nullptr : &*row;
}

void EsiDictionary::finish() {
  std::vector<EntryDeclaration>& rows = objects_.rows();
  rows.reserve(rows_);
  for (auto& [index, held] : held_) {
    rows.insert(rows.end(), held.rows.begin(), held.rows.end());
  }
  held_.clear();
}

void EsiDictionary::add_object(pugi::xml_node object, const EsiTypes& types, const EsiSlot& slot) {
  const pugi::xml_node index_element = object.child("Index");
  const std::optional<std::uint16_t> index = slot.index_of(index_element);
  if (fills(object, index.value_or(0), 1)) {
    return;
  }
  if (!index || *index == 0) {
    notes_.add(
        ImportKind::left_out, object, "object-index",
        fmt::format("\"{}\" is no index of an object", readable(index_element.child_value())));
    return;
  }
  const auto found = held_.find(*index);
  if (found != held_.end()) {
    if (!slot.module || !found->second.overwritable) {
      notes_.add(ImportKind::repaired, object, "object-twice",
                 fmt::format("object {:04X}h is there again; the first counts", *index));
      return;
    }
    rows_ -= found->second.rows.size();
    held_.erase(found);
  }
  const std::string_view type_name = child_text(object, "Type");
  Held held;
  held.overwritable =
      !slot.module && esi_truth(attribute_text(index_element, "OverwrittenByModule"), false);
  if (const pugi::xml_node structure = types.structure(type_name)) {
    held.rows = structured(object, *index, structure, types);
  } else {
    held.rows.push_back(single(object, *index, types));
  }
  if (fills(object, *index, held.rows.size())) {
    return;
  }
  rows_ += held.rows.size();
  held_.emplace(*index, std::move(held));
}

/// Whether so many rows are too many; then all that follows is left out as well, so that a file
/// without end takes no time without end.
bool EsiDictionary::fills(pugi::xml_node object, std::uint16_t index, std::size_t rows) {
  constexpr std::size_t kMostVisited = 4 * kMostRows;
  if (rows_ + rows > kMostRows || ++visited_ > kMostVisited) {
    full_ = true;
    notes_.add(ImportKind::left_out, object, "too-many-entries",
               fmt::format("object {:04X}h and all that follow: a device has at most {} entries",
                           index, kMostRows));
  }
  return full_;
}

EntryDeclaration EsiDictionary::single(pugi::xml_node object, std::uint16_t index,
                                       const EsiTypes& types) {
  const std::string_view type_name = child_text(object, "Type");
  const EsiType type = types.resolve(type_name, esi_bits(child_text(object, "BitSize")), object);
  EntryDeclaration row;
  row.index = index;
  std::string name = esi_name(object);
  row.name = objects_.keep(name.empty() ? fmt::format("Object {:04X}h", index) : std::move(name));
  row.object_code =
      type.type == DataType::domain ? ObjectCode::domain_object : ObjectCode::variable;
  row.type = type.type;
  set_flags(row, flags_of(object.child("Flags"), object));
  set_values(row, type, type_name, types, {object.child("Info"), object});
  return row;
}

void EsiDictionary::add_elements(pugi::xml_node array, std::size_t first, pugi::xml_node declared,
                                 const EsiTypes& types, std::vector<Item>& items) {
  const pugi::xml_node bounds = array.child("ArrayInfo");
  const std::string_view element = child_text(array, "BaseType");
  const std::size_t elements =
      esi_number_up_to(child_text(bounds, "Elements"), UINT32_MAX).value_or(0);
  const std::size_t whole = esi_bits(child_text(array, "BitSize"));
  const EsiType type = types.resolve(element, elements == 0 ? 0 : whole / elements, array);
  const std::size_t offset = esi_bits(child_text(declared, "BitOffs"));
  for (std::size_t i = 0; i < elements; ++i) {
    if (first + i > kHighestSubindex) {
      notes_.add(ImportKind::left_out, array, "too-many-subindices",
                 fmt::format("an array of {} elements: subindices end at 255", elements));
      break;
    }
    items.push_back({.subindex = first + i,
                     .name = subindex_name(first + i),
                     .type_name = element,
                     .type = type,
                     .bit_offset = offset + i * type.bits,
                     .flags = declared.child("Flags"),
                     .declared_info = declared.child("Info"),
                     .declared = has_values(declared) ? declared : pugi::xml_node(),
                     .of_array = true,
                     .info = {}});
  }
}

const std::vector<EsiDictionary::Item>& EsiDictionary::items_of(pugi::xml_node structure,
                                                                const EsiTypes& types) {
  const auto known = items_.find(structure.internal_object());
  if (known != items_.end()) {
    return known->second;
  }
  return items_.emplace(structure.internal_object(), declared_items(structure, types))
      .first->second;
}

std::vector<EsiDictionary::Item> EsiDictionary::declared_items(pugi::xml_node structure,
                                                               const EsiTypes& types) {
  std::vector<Item> items;
  const auto lower_bound = [](pugi::xml_node array) {
    return esi_number_up_to(child_text(array.child("ArrayInfo"), "LBound"), kHighestSubindex)
        .value_or(1);
  };
  if (structure.child("ArrayInfo")) {
    add_elements(structure, std::max<std::size_t>(lower_bound(structure), 1), {}, types, items);
  }
  std::size_t next = 0;
  for (const pugi::xml_node declared : structure.children("SubItem")) {
    const std::string_view written = child_text(declared, "SubIdx");
    const std::optional<EsiNumber> given = esi_number(written);
    std::size_t subindex = given ? given->bits : next;
    if (!written.empty() && !given) {
      notes_.add(ImportKind::repaired, declared, "subindex",
                 fmt::format("\"{}\" is no subindex; {} follows", readable(written), next));
    }
    if (subindex > kHighestSubindex || items.size() > kHighestSubindex) {
      notes_.add(ImportKind::left_out, declared, "too-many-subindices",
                 fmt::format("subindex {}: subindices end at 255", subindex));
      break;
    }
    const std::string_view type_name = child_text(declared, "Type");
    const pugi::xml_node array = types.structure(type_name);
    if (array.child("ArrayInfo")) {
      const std::size_t first = given && given->bits != 0
                                    ? subindex
                                    : std::max<std::size_t>({lower_bound(array), next, 1});
      add_elements(array, first, declared, types, items);
      subindex = items.empty() ? first : items.back().subindex;
    } else {
      std::string name = esi_name(declared);
      items.push_back(
          {.subindex = subindex,
           .name = name.empty() ? subindex_name(subindex) : std::move(name),
           .type_name = type_name,
           .type = types.resolve(type_name, esi_bits(child_text(declared, "BitSize")), declared),
           .bit_offset = esi_bits(child_text(declared, "BitOffs")),
           .flags = declared.child("Flags"),
           .declared_info = declared.child("Info"),
           .declared = has_values(declared) ? declared : pugi::xml_node(),
           .of_array = false,
           .info = {}});
    }
    next = subindex + 1;
  }
  std::ranges::stable_sort(items, {}, &Item::subindex);
  const auto again = std::unique(items.begin(), items.end(), [](const Item& a, const Item& b) {
    return a.subindex == b.subindex;
  });
  if (again != items.end()) {
    notes_.add(ImportKind::repaired, structure, "subindex-twice",
               fmt::format("the data type {} has subindices twice; the first of each counts",
                           readable(child_text(structure, "Name"))));
    items.erase(again, items.end());
  }
  if (items.empty() || items.front().subindex != 0) {
    Item count;
    count.name = subindex_name(0);
    items.insert(items.begin(), std::move(count));
  }
  return items;
}

/// Gives each item the <Info> that the object has for it. Most files have as many of these as
/// subindices, in order; some leave out a few, and then names decide.
void EsiDictionary::match_infos(pugi::xml_node object, std::vector<Item>& items) {
  std::vector<pugi::xml_node> infos;
  for (const pugi::xml_node info : object.child("Info").children("SubItem")) {
    if (infos.size() > kHighestSubindex) {
      break;
    }
    infos.push_back(info);
  }
  const bool in_order = infos.size() == items.size();
  std::size_t next = 0;
  if (infos.size() + 1 == items.size() &&
      esi_name(infos.empty() ? object : infos.front()) != items.front().name) {
    next = 1;  // all but the count
  }
  for (const pugi::xml_node info : infos) {
    const std::string name = esi_name(info);
    if (!in_order) {
      const auto from = items.begin() + static_cast<std::ptrdiff_t>(next);
      const auto named =
          std::find_if(from, items.end(), [&name](const Item& each) { return each.name == name; });
      if (named != items.end()) {
        next = static_cast<std::size_t>(named - items.begin());
      }
    }
    if (next >= items.size()) {
      notes_.add(ImportKind::left_out, info, "value-without-subindex",
                 "the object has more values than its data type has subindices");
      return;
    }
    Item& item = items[next++];
    item.info = info.child("Info");
    if (item.of_array && !name.empty()) {
      item.name = name;
    }
  }
}

std::vector<EntryDeclaration> EsiDictionary::structured(pugi::xml_node object, std::uint16_t index,
                                                        pugi::xml_node structure,
                                                        const EsiTypes& types) {
  std::vector<Item> items = items_of(structure, types);
  match_infos(object, items);
  const bool all_elements =
      std::all_of(items.begin() + 1, items.end(), [](const Item& each) { return each.of_array; });
  const bool array = is_standard_array(index) || (all_elements && items.size() > 1);
  // Few files give the bytes of the whole object at once.
  std::optional<std::vector<std::byte>> whole;
  if (!object.child("Info").child("SubItem")) {
    whole = esi_bytes(object.child("Info").child_value("DefaultData"));
  }
  std::vector<EntryDeclaration> rows;
  rows.reserve(items.size());
  for (const Item& item : items) {
    const pugi::xml_node flags = item.flags;
    EntryDeclaration row;
    row.index = index;
    row.subindex = static_cast<std::uint8_t>(item.subindex);
    row.name = objects_.keep(item.name);
    row.object_code = array ? ObjectCode::array : ObjectCode::record;
    row.type = item.subindex == 0 ? DataType::unsigned8 : item.type.type;
    if (item.subindex == 0 && !flags.child("Access")) {
      row.access = Access::read_only;
    } else {
      set_flags(row, flags_of(flags, object));
    }
    const EsiType type = item.subindex == 0 ? EsiType{DataType::unsigned8, 8} : item.type;
    set_values(row, type, item.type_name, types, {item.info, item.declared_info, item.declared});
    if (whole && !whole->empty() && !is_string(row.type) && !row.default_value.documented) {
      row.default_value = dictionary::Number(
          esi_extended(row.type, esi_bits_at(*whole, item.bit_offset, bit_length(row.type))));
    }
    rows.push_back(row);
  }
  std::string name = esi_name(object);
  rows.front().object_name =
      objects_.keep(name.empty() ? fmt::format("Object {:04X}h", index) : std::move(name));
  rows.front().mapping = PdoMapping::no;
  rows.front().range = std::nullopt;
  set_count(rows.front(), items.back().subindex, object);
  return rows;
}

/// Subindex 0 tells the highest subindex; that of mappings and assignments may be less.
void EsiDictionary::set_count(EntryDeclaration& row, std::size_t highest, pugi::xml_node at) {
  if (!row.default_value.documented) {
    row.default_value = dictionary::Number(highest);
    return;
  }
  const bool counts = esi_is_pdo(row.index) || (row.index >= 0x1C10 && row.index < 0x1C30) ||
                      row.access == Access::read_write;
  const std::uint64_t value = row.default_value.number.bits;
  if (value > highest || (value < highest && !counts)) {
    if (value != 0 || !counts) {
      notes_.add(ImportKind::repaired, at, "highest-subindex",
                 fmt::format("object {:04X}h tells {} as its highest subindex, but has {}",
                             row.index, value, highest));
    }
    row.default_value = dictionary::Number(highest);
  }
}

void EsiDictionary::set_flags(EntryDeclaration& row, const Flags& flags) const {
  row.access = flags.access;
  row.mapping = flags.mapping;
  row.write_states = flags.write_states;
}

/// The flags of a subindex count, then those of the object.
EsiDictionary::Flags EsiDictionary::flags_of(pugi::xml_node own, pugi::xml_node object) {
  const pugi::xml_node outer = object.child("Flags");
  const auto flag = [own, outer](const char* name) {
    const pugi::xml_node element = own.child(name);
    return element ? element : outer.child(name);
  };
  Flags flags;
  const pugi::xml_node element = flag("Access");
  const std::optional<Access> access = access_of(trimmed(element.child_value()));
  if (access) {
    flags.access = *access;
  } else {
    notes_.add(ImportKind::assumed, element ? element : object, "access",
               "the file does not say whether this can be written; it can");
  }
  flags.write_states = states_of(attribute_text(element, "WriteRestrictions"));
  if (states_of(attribute_text(element, "ReadRestrictions")) != dictionary::kAllNetworkStates) {
    notes_.add(ImportKind::left_out, element, "read-restrictions",
               "the file lets this be read in some states only; it can be read in all");
  }
  flags.mapping = mapping_of(trimmed(flag("PdoMapping").child_value()));
  return flags;
}

void EsiDictionary::set_values(EntryDeclaration& row, const EsiType& type,
                               std::string_view type_name, const EsiTypes& types,
                               std::initializer_list<pugi::xml_node> places) {
  row.default_value.documented = false;
  if (is_string(row.type)) {
    constexpr std::size_t kMostText = std::size_t{1} << 26;  // in all objects
    for (const pugi::xml_node place : places) {
      if (text_length_ > kMostText) {
        return;
      }
      if (std::optional<std::string> text = esi_string(place, row.type)) {
        text_length_ += text->size();
        row.default_value.text = objects_.keep(std::move(*text));
        row.default_value.documented = true;
        return;
      }
    }
    if (row.type == DataType::octet_string) {
      row.default_value.text = zeros((type.bits + 7) / 8);
    }
    return;
  }
  for (const pugi::xml_node place : places) {
    std::optional<EsiValue> value =
        esi_value(place, row.type, "DefaultData", "DefaultValue", "DefaultString");
    if (value) {
      if (!value->repaired.empty()) {
        notes_.add(ImportKind::repaired, place, "default-value", std::move(value->repaired));
      }
      row.default_value = value->number;
      break;
    }
    if (!child_text(place, "DefaultData").empty() || !child_text(place, "DefaultValue").empty()) {
      notes_.add(ImportKind::left_out, place, "default-value",
                 fmt::format("the value of {:04X}h:{:02X} cannot be read as {}", row.index,
                             row.subindex, dictionary::to_text(row.type).view()));
    }
  }
  for (const pugi::xml_node place : places) {
    if (const auto range = esi_range(place, row.type)) {
      row.range = range;
      break;
    }
  }
  row.note = enumeration_text(types.enumeration(type_name));
}

/// "0 = off, 1 = on", for people.
std::string_view EsiDictionary::enumeration_text(pugi::xml_node type) {
  if (!type) {
    return {};
  }
  const auto known = enumerations_.find(type.internal_object());
  if (known != enumerations_.end()) {
    return known->second;
  }
  constexpr std::size_t kLongest = 200;
  std::string text;
  for (const pugi::xml_node info : type.children("EnumInfo")) {
    std::string value =
        fmt::format("{}{} = {}", text.empty() ? "" : ", ", readable(child_text(info, "Enum")),
                    readable(child_text(info, "Text")));
    if (text.size() + value.size() > kLongest) {
      text += text.empty() ? "" : ", ...";
      break;
    }
    text += value;
  }
  return enumerations_.emplace(type.internal_object(), objects_.keep(std::move(text)))
      .first->second;
}

/// What octet strings hold of which no value is told. One text serves for all.
std::string_view EsiDictionary::zeros(std::size_t count) {
  constexpr std::size_t kMost = 1024;
  if (zeros_.empty()) {
    zeros_ = objects_.keep(std::string(kMost, '\0'));
  }
  return zeros_.substr(0, count);
}

}  // namespace stator::formats
