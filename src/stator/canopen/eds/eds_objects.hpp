// Objects as a file about a CANopen device writes them, whatever its format, and the declarations
// that are made of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/canopen/eds/eds_file.hpp"
#include "stator/canopen/eds/import_notes.hpp"
#include "stator/dictionary/import_report.hpp"
#include "stator/dictionary/owned_declarations.hpp"

namespace stator::canopen {

/// A dictionary of more entries is refused: no device has so many, and memory is finite.
inline constexpr std::size_t kMostEntries = 65'536;

/// What a file says at one place; without text it says nothing.
struct WrittenText {
  std::string_view text{};
  std::size_t line = 0;  ///< from 1
};

/// Whether the file lets an entry be in PDOs, before its access is looked at.
enum class WrittenMapping : std::uint8_t {
  no,
  as_accessed,  ///< in those that its access allows
  receive,
  transmit,
};

/// An entry, or what an object's own section says for all of its entries. The texts stand in the
/// file.
struct WrittenEntry {
  std::uint8_t subindex = 0;
  std::size_t line = 0;  ///< where it begins
  WrittenText name;
  /// Number of its type; nothing: the file names none, or none that is a number.
  std::optional<std::uint32_t> data_type;
  std::optional<std::uint32_t> object_type;  ///< 7, 2, or what else the file says
  WrittenText access;
  WrittenText default_value;
  WrittenText value;  ///< of this one device, instead of the default
  WrittenText low_limit;
  WrittenText high_limit;
  WrittenMapping mapping = WrittenMapping::no;
};

/// An object with its entries.
struct WrittenObject {
  std::uint16_t index = 0;
  /// What is said of the object as a whole, or of its only entry.
  WrittenEntry own;
  bool has_own = false;                     ///< the file says something of it as a whole
  std::optional<std::uint32_t> sub_number;  ///< how many entries there should be
  std::uint8_t compact = 0;                 ///< entries 1..n are like `own` (CiA 306-1 §4.6.3.4)
  std::vector<WrittenEntry> entries;        ///< in any order, none twice
  std::map<std::uint8_t, WrittenText> compact_names;   ///< of some of those
  std::map<std::uint8_t, WrittenText> compact_values;  ///< the same, for `value`
};

/// Declares `objects`, which stand in the order of their indices, none twice. Texts are copied.
/// What cannot be so is repaired or left out, and `notes` say it; an error says that there are too
/// many entries.
[[nodiscard]] base::Expected<dictionary::OwnedDeclarations, dictionary::ImportError>
declare_objects(const std::vector<WrittenObject>& objects, ImportNotes& notes);

/// A number for the identity of a device from a text such as "0x00000286"; notes what is none.
[[nodiscard]] std::uint32_t identity_number(const WrittenText& written, std::string_view what,
                                            ImportNotes& notes);

/// Takes parts of the identity that the file does not say from the defaults of 1018h, and notes
/// where they differ.
void complete_identity(EdsFile& file, ImportNotes& notes);

/// "2000h:01".
[[nodiscard]] std::string entry_text(std::uint16_t index, std::uint8_t subindex);
/// "2000h".
[[nodiscard]] std::string object_text(std::uint16_t index);
/// What a file says, in quotes, for a note: readable and not too long.
[[nodiscard]] std::string quoted(std::string_view text);

}  // namespace stator::canopen
