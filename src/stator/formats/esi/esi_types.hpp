// The data types of an ESI file: those that everybody knows by name, and those that a dictionary
// declares.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <unordered_map>

#include <pugixml.hpp>

#include "stator/dictionary/data_type.hpp"
#include "stator/formats/esi/esi_xml.hpp"

namespace stator::formats {

/// The type of one value.
struct EsiType {
  dictionary::DataType type = dictionary::DataType::unsigned32;
  std::size_t bits = 0;  ///< length of the value; of strings as declared, 0 if it is not
};

/// A type by the names of IEC 61131-3, ETG.1000.6 and CiA 301, with lengths: "UINT", "BIT3",
/// "STRING(20)", "ARRAY [0..7] OF BYTE", "UNSIGNED16"; nothing for others.
[[nodiscard]] std::optional<EsiType> esi_basic_type(std::string_view name);

/// The type of so many bits: a number if there is one of that length or, up to 64 bits, the next
/// longer one, else bytes.
[[nodiscard]] dictionary::DataType esi_type_of_bits(std::size_t bits, bool is_signed);

/// The types that a dictionary declares.
class EsiTypes {
 public:
  /// `outer` has the types that are looked for behind these, null for none. Both must outlive this.
  EsiTypes(const EsiTypes* outer, EsiNotes& notes) : outer_(outer), notes_(&notes) {}

  /// Takes those of a <DataTypes>; of several with one name the first counts.
  void add(pugi::xml_node data_types);

  /// The <DataType> that gives the name its subindices, by aliases: one with <SubItem> or with
  /// <ArrayInfo>. Null for types of single values; an array of bytes from 0 is one.
  [[nodiscard]] pugi::xml_node structure(std::string_view name) const;
  /// The <DataType> that gives the name its <EnumInfo>, by aliases; null if there is none.
  [[nodiscard]] pugi::xml_node enumeration(std::string_view name) const;
  /// The type of a value whose type has this name; if that is not known, a type of `bits`, and
  /// there is a note about `at`.
  [[nodiscard]] EsiType resolve(std::string_view name, std::size_t bits, pugi::xml_node at) const;
  /// The same without a note; nothing if it is not known.
  [[nodiscard]] std::optional<EsiType> known(std::string_view name, std::size_t bits) const;

 private:
  /// A <DataType>, read once: objects are many.
  struct Declared {
    pugi::xml_node node;
    std::size_t bits = 0;           // 0: not said
    std::string_view base;          // <BaseType>
    bool record = false;            // it has <SubItem>
    bool array = false;             // it has <ArrayInfo>
    bool enumerated = false;        // it has <EnumInfo>
    bool negative = false;          // of which one is below 0
    std::size_t first_element = 0;  // <LBound>
    std::size_t elements = 1;       // <Elements>
  };

  [[nodiscard]] const Declared* find(std::string_view name) const;

  const EsiTypes* outer_;
  EsiNotes* notes_;
  std::unordered_map<std::string_view, Declared> types_;
};

/// The text of <BitSize> or <BitLen>, 0 if there is none or it is more than any value has.
[[nodiscard]] std::size_t esi_bits(std::string_view text);

}  // namespace stator::formats
