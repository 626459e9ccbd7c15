// The object dictionary of an ESI file: <Objects> with the types that give them their subindices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <pugixml.hpp>

#include "stator/dictionary/declaration.hpp"
#include "stator/dictionary/owned_declarations.hpp"
#include "stator/formats/esi/esi_slot.hpp"
#include "stator/formats/esi/esi_types.hpp"
#include "stator/formats/esi/esi_xml.hpp"

namespace stator::formats {

/// Collects the objects of a device and of its modules.
class EsiDictionary {
 public:
  /// Texts are kept in `objects`, to which finish() adds the rows.
  EsiDictionary(dictionary::OwnedDeclarations& objects, EsiNotes& notes)
      : objects_(objects), notes_(notes) {}

  /// Takes the <Object>s of an <Objects>, or of another element that has them.
  void add(pugi::xml_node objects, const EsiTypes& types, const EsiSlot& slot);

  /// Whether there is such an object, and a module's cannot take its place.
  [[nodiscard]] bool has(std::uint16_t index) const {
    const auto found = held_.find(index);
    return found != held_.end() && !found->second.overwritable;
  }
  /// Whether all that follows is left out.
  [[nodiscard]] bool is_full() const { return full_; }
  /// An entry, null if there is none.
  [[nodiscard]] dictionary::EntryDeclaration* find(std::uint16_t index, std::uint8_t subindex);
  /// Brings all rows in order to where they are wanted. To be called once, at last.
  void finish();

 private:
  /// One value of an object before it is a row.
  struct Item {
    std::size_t subindex = 0;
    std::string name;
    std::string_view type_name;
    EsiType type;
    std::size_t bit_offset = 0;
    // Of the <SubItem> of its type, looked up once since many objects have the same.
    pugi::xml_node flags;
    pugi::xml_node declared_info;
    pugi::xml_node declared;  // itself, if it has values
    bool of_array = false;    // has no name of its own
    pugi::xml_node info;      // <Info> of the object's <SubItem>
  };
  struct Flags {
    dictionary::Access access = dictionary::Access::read_write;
    dictionary::PdoMapping mapping = dictionary::PdoMapping::no;
    std::uint8_t write_states = dictionary::kAllNetworkStates;
  };
  struct Held {
    std::vector<dictionary::EntryDeclaration> rows;
    bool overwritable = false;  // by a module's
  };

  void add_object(pugi::xml_node object, const EsiTypes& types, const EsiSlot& slot);
  const std::vector<Item>& items_of(pugi::xml_node structure, const EsiTypes& types);
  std::vector<Item> declared_items(pugi::xml_node structure, const EsiTypes& types);
  void add_elements(pugi::xml_node array, std::size_t first, pugi::xml_node declared,
                    const EsiTypes& types, std::vector<Item>& items);
  void match_infos(pugi::xml_node object, std::vector<Item>& items);
  std::vector<dictionary::EntryDeclaration> structured(pugi::xml_node object, std::uint16_t index,
                                                       pugi::xml_node structure,
                                                       const EsiTypes& types);
  dictionary::EntryDeclaration single(pugi::xml_node object, std::uint16_t index,
                                      const EsiTypes& types);
  dictionary::EntryDeclaration count_row(std::uint16_t index, const Flags& flags);
  void set_count(dictionary::EntryDeclaration& row, std::size_t highest, pugi::xml_node at);
  void set_flags(dictionary::EntryDeclaration& row, const Flags& flags) const;
  Flags flags_of(pugi::xml_node own, pugi::xml_node object);
  void set_values(dictionary::EntryDeclaration& row, const EsiType& type,
                  std::string_view type_name, const EsiTypes& types,
                  std::initializer_list<pugi::xml_node> places);
  std::string_view enumeration_text(pugi::xml_node type);
  std::string_view zeros(std::size_t count);
  [[nodiscard]] bool fills(pugi::xml_node object, std::uint16_t index, std::size_t rows);

  dictionary::OwnedDeclarations& objects_;
  EsiNotes& notes_;
  std::map<std::uint16_t, Held> held_;
  // By the elements of their types, since many objects have the same.
  std::unordered_map<const void*, std::vector<Item>> items_;
  std::unordered_map<const void*, std::string_view> enumerations_;
  std::string_view zeros_;
  std::size_t rows_ = 0;
  std::size_t visited_ = 0;      // <Object>s, with those left out
  std::size_t text_length_ = 0;  // of all values that are strings
  bool full_ = false;
};

}  // namespace stator::formats
