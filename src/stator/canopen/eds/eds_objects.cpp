#include "stator/canopen/eds/eds_objects.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "stator/canopen/eds/eds_defaults.hpp"
#include "stator/canopen/eds/eds_values.hpp"

namespace stator::canopen {

namespace {

using dictionary::Access;
using dictionary::DataType;
using dictionary::EntryDeclaration;
using dictionary::ImportKind;
using dictionary::ObjectCode;
using dictionary::PdoMapping;

/// Objects below are types (CiA 301 table 43), which no SDO reads.
constexpr std::uint16_t kFirstObject = 0x1000;
/// Describes the object's structure (CiA 301 §7.4.1), and does not count as one of its entries.
constexpr std::uint8_t kStructureSubindex = 0xFF;
/// CiA 306-1 §4.6.3.4: subindices that a compact description has at most.
constexpr std::uint8_t kMostCompact = 0xFE;
constexpr std::string_view kCountName = "Highest sub-index supported";

bool is_pdo_mapping(std::uint16_t index) {
  return (index >= 0x1600 && index < 0x1800) || (index >= 0x1A00 && index < 0x1C00);
}

bool has_subindex(const std::vector<WrittenEntry>& entries, std::uint8_t subindex) {
  return std::ranges::find(entries, subindex, &WrittenEntry::subindex) != entries.end();
}

/// All entries that are numbered from 1 have the same type, as those of an array do.
bool of_one_type(const std::vector<WrittenEntry>& entries) {
  std::optional<std::uint32_t> type;
  for (const WrittenEntry& entry : entries) {
    if (entry.subindex == 0 || entry.subindex == kStructureSubindex) {
      continue;
    }
    if (!entry.data_type || (type && *type != *entry.data_type)) {
      return false;
    }
    type = entry.data_type;
  }
  return true;
}

/// Makes the rows.
class Declarer {
 public:
  explicit Declarer(ImportNotes& notes) : notes_(notes) {}

  base::Expected<dictionary::OwnedDeclarations, dictionary::ImportError> declare(
      const std::vector<WrittenObject>& objects) {
    for (const WrittenObject& object : objects) {
      if (object.index < kFirstObject) {
        note(ImportKind::left_out, object, "type-definition",
             "describes a type; objects begin at 1000h");
        continue;
      }
      declare_object(object);
      if (declarations_.rows().size() > kMostEntries) {
        return base::Unexpected<dictionary::ImportError>{
            {object.own.line, "too-many-entries",
             "the dictionary has more than " + std::to_string(kMostEntries) +
                 " entries; take out those that no master needs"}};
      }
    }
    return std::move(declarations_);
  }

 private:
  void note(ImportKind kind, const WrittenObject& object, std::string_view rule,
            const std::string& text) {
    notes_.add(kind, object.own.line, rule, object_text(object.index) + ": " + text);
  }
  void note(ImportKind kind, const WrittenObject& object, const WrittenEntry& entry,
            std::size_t line, std::string_view rule, const std::string& text) {
    notes_.add(kind, line == 0 ? entry.line : line, rule,
               entry_text(object.index, entry.subindex) + ": " + text);
  }

  // What kind of object it is.

  void declare_object(const WrittenObject& object) {
    if (!object.has_own) {
      note(ImportKind::repaired, object, "object-missing",
           "has entries, but nothing that describes it as a whole");
    }
    const bool several =
        object.compact > 0 || std::ranges::any_of(object.entries, [](const WrittenEntry& entry) {
          return entry.subindex != 0;
        });
    switch (object.own.object_type.value_or(0)) {
      case static_cast<std::uint32_t>(ObjectCode::variable):
      case static_cast<std::uint32_t>(ObjectCode::domain_object):
        declare_declared_variable(object, several);
        break;
      case static_cast<std::uint32_t>(ObjectCode::array):
        declare_declared_structure(object, ObjectCode::array, several);
        break;
      case static_cast<std::uint32_t>(ObjectCode::record):
        declare_declared_structure(object, ObjectCode::record, several);
        break;
      default:
        declare_unknown(object, several);
    }
  }

  void declare_declared_variable(const WrittenObject& object, bool several) {
    if (several) {
      note(ImportKind::repaired, object, "variable-with-entries",
           "is a variable by its object type, but has entries; it is taken as an array or record");
      declare_entries(object, guessed_structure(object), object.compact);
      return;
    }
    declare_variable(object);
  }

  void declare_declared_structure(const WrittenObject& object, ObjectCode code, bool several) {
    if (several) {
      declare_entries(object, code, object.compact);
      return;
    }
    const bool lone_value =
        object.entries.size() == 1 && object.entries.front().data_type &&
        *object.entries.front().data_type != static_cast<std::uint32_t>(DataType::unsigned8);
    const bool like_variable =
        object.entries.empty() && object.own.data_type && object.sub_number.value_or(0) < 2;
    if (lone_value || like_variable) {
      note(ImportKind::repaired, object, "structure-without-entries",
           "is an array or record by its object type, but has one value only; it is taken as a "
           "variable");
      declare_variable(object);
      return;
    }
    declare_entries(object, code, missing_entries(object));
  }

  /// The file does not say what it is, or says it with a number that no object has.
  void declare_unknown(const WrittenObject& object, bool several) {
    if (object.own.object_type) {
      note(ImportKind::repaired, object, "object-type-unknown",
           "has object type " + std::to_string(*object.own.object_type) +
               ", which is no variable, array, record or domain; its entries say what it is");
    }
    if (several) {
      declare_entries(object, guessed_structure(object), object.compact);
    } else if (object.sub_number.value_or(0) > 1) {
      declare_entries(object, guessed_structure(object), missing_entries(object));
    } else {
      declare_variable(object);
    }
  }

  static ObjectCode guessed_structure(const WrittenObject& object) {
    return object.compact > 0 || of_one_type(object.entries) ? ObjectCode::array
                                                             : ObjectCode::record;
  }

  /// How many entries an object has that is said to have some, and has a type, but none of them.
  std::uint8_t missing_entries(const WrittenObject& object) {
    if (!object.own.data_type || object.sub_number.value_or(0) < 2) {
      return 0;
    }
    const auto count =
        static_cast<std::uint8_t>(std::min<std::uint32_t>(*object.sub_number - 1, kMostCompact));
    note(ImportKind::repaired, object, "entries-missing",
         "has no description of its entries; " + std::to_string(int{count}) +
             " of its own type are made");
    return count;
  }

  // Objects of one entry.

  void declare_variable(const WrittenObject& object) {
    const bool in_entry = !object.entries.empty() && (!object.own.data_type || !object.has_own);
    WrittenEntry entry = in_entry ? object.entries.front() : object.own;
    if (entry.name.text.empty()) {
      entry.name = object.own.name;
    }
    const bool domain =
        object.own.object_type.value_or(0) == static_cast<std::uint32_t>(ObjectCode::domain_object);
    EntryDeclaration row;
    row.index = object.index;
    row.object_code = domain ? ObjectCode::domain_object : ObjectCode::variable;
    row.name = keep_name(entry.name, "Object " + object_text(object.index), object, entry);
    row.type = type_of(object, entry, false);
    declare_access(row, object, entry);
    declare_values(row, entry, declarations_, notes_);
    declarations_.rows().push_back(row);
  }

  // Objects of several entries.

  void declare_entries(const WrittenObject& object, ObjectCode code, std::uint8_t compact) {
    compact = std::min(compact, kMostCompact);
    std::vector<WrittenEntry> entries = object.entries;
    for (unsigned subindex = 1; subindex <= compact; ++subindex) {
      if (!has_subindex(object.entries, static_cast<std::uint8_t>(subindex))) {
        entries.push_back(compact_entry(object, static_cast<std::uint8_t>(subindex)));
      }
    }
    std::ranges::sort(entries, {}, &WrittenEntry::subindex);
    note_beyond_compact(object, compact);
    check_sub_number(object, compact);
    const std::size_t first_row = declarations_.rows().size();
    declare_count(object, code, entries, compact > 0);
    for (const WrittenEntry& entry : entries) {
      if (entry.subindex != 0) {
        declare_entry(object, code, entry);
      }
    }
    count_mapped(object, first_row);
  }

  WrittenEntry compact_entry(const WrittenObject& object, std::uint8_t subindex) {
    WrittenEntry entry = object.own;
    entry.subindex = subindex;
    entry.object_type.reset();
    if (const auto name = object.compact_names.find(subindex); name != object.compact_names.end()) {
      entry.name = name->second;
    } else if (!entry.name.text.empty()) {
      std::string numbered = std::string(entry.name.text) + " " + std::to_string(int{subindex});
      entry.name.text = declarations_.keep(std::move(numbered));
    }
    if (const auto value = object.compact_values.find(subindex);
        value != object.compact_values.end()) {
      entry.value = value->second;
    }
    return entry;
  }

  void note_beyond_compact(const WrittenObject& object, std::uint8_t compact) {
    for (const auto* texts : {&object.compact_names, &object.compact_values}) {
      const auto beyond = texts->upper_bound(compact);
      if (beyond != texts->end()) {
        notes_.add(ImportKind::left_out, beyond->second.line, "compact-beyond",
                   object_text(object.index) + ": has names or values for subindices above " +
                       std::to_string(int{compact}) + ", its last");
      }
    }
  }

  void check_sub_number(const WrittenObject& object, std::uint8_t compact) {
    const auto described = static_cast<std::uint32_t>(std::ranges::count_if(
        object.entries,
        [](const WrittenEntry& entry) { return entry.subindex != kStructureSubindex; }));
    if (object.sub_number && compact == 0 && *object.sub_number != described) {
      note(ImportKind::repaired, object, "sub-number",
           "should have " + std::to_string(*object.sub_number) + " entries and describes " +
               std::to_string(described) + "; those described count");
    }
  }

  /// Subindex 0, which says what the highest one is.
  void declare_count(const WrittenObject& object, ObjectCode code,
                     const std::vector<WrittenEntry>& entries, bool compact) {
    std::uint8_t highest = 0;
    for (const WrittenEntry& entry : entries) {
      highest = entry.subindex != kStructureSubindex ? std::max(highest, entry.subindex) : highest;
    }
    EntryDeclaration row;
    row.index = object.index;
    row.object_code = code;
    row.type = DataType::unsigned8;
    row.object_name =
        keep_name(object.own.name, "Object " + object_text(object.index), object, object.own);
    if (entries.empty() || entries.front().subindex != 0) {
      if (!compact) {  // of which the standard describes none
        note(ImportKind::repaired, object, "subindex-0-missing",
             "has no subindex 0; one is added that says " + std::to_string(int{highest}));
      }
      row.name = kCountName;
      row.access = Access::read_only;
      row.default_value = highest;
      declarations_.rows().push_back(row);
      return;
    }
    const WrittenEntry& entry = entries.front();
    if (entry.data_type && *entry.data_type != static_cast<std::uint32_t>(DataType::unsigned8)) {
      note(ImportKind::repaired, object, entry, 0, "subindex-0-type",
           "has another type than UNSIGNED8, which subindex 0 has");
    }
    row.name = keep_name(entry.name, std::string(kCountName), object, entry);
    if (entry.access.text.empty()) {
      row.access = Access::read_only;
    } else {
      declare_access(row, object, entry);
    }
    declare_values(row, entry, declarations_, notes_);
    if (written_start(entry).text.empty() && object.index != 0x1003) {
      row.default_value = dictionary::undocumented(highest);
      row.range.reset();
    }
    declarations_.rows().push_back(row);
  }

  void declare_entry(const WrittenObject& object, ObjectCode code, const WrittenEntry& entry) {
    EntryDeclaration row;
    row.index = object.index;
    row.subindex = entry.subindex;
    row.object_code = code;
    row.name =
        keep_name(entry.name, "Sub-index " + std::to_string(int{entry.subindex}), object, entry);
    row.type = type_of(object, entry, true);
    declare_access(row, object, entry);
    declare_values(row, entry, declarations_, notes_);
    declarations_.rows().push_back(row);
  }

  /// A mapping whose number of objects the file does not say has as many as stand in it.
  void count_mapped(const WrittenObject& object, std::size_t first_row) {
    std::vector<EntryDeclaration>& rows = declarations_.rows();
    if (!is_pdo_mapping(object.index) || rows[first_row].default_value.documented) {
      return;
    }
    std::uint8_t mapped = 0;
    for (std::size_t i = first_row + 1; i < rows.size(); ++i) {
      if (rows[i].subindex != mapped + 1 || rows[i].default_value.number.bits == 0) {
        break;
      }
      ++mapped;
    }
    rows[first_row].default_value = dictionary::undocumented(mapped);
    note(ImportKind::assumed, object, "mapped-count-assumed",
         "does not say how many objects are mapped; " + std::to_string(int{mapped}) +
             " have a default");
  }

  // Parts of a declaration.

  std::string_view keep_name(const WrittenText& name, std::string otherwise,
                             const WrittenObject& object, const WrittenEntry& entry) {
    if (!name.text.empty()) {
      return declarations_.keep(readable_text(name.text));
    }
    if (object.has_own) {
      note(ImportKind::assumed, object, entry, 0, "name-missing", "has no name");
    }
    return declarations_.keep(std::move(otherwise));
  }

  /// `inherits`: an entry that names no type has that of its object.
  DataType type_of(const WrittenObject& object, const WrittenEntry& entry, bool inherits) {
    const bool domain =
        entry.object_type.value_or(0) == static_cast<std::uint32_t>(ObjectCode::domain_object);
    std::optional<std::uint32_t> number = entry.data_type;
    if (!number && inherits && !domain) {
      number = object.own.data_type;
    }
    if (!number && domain) {
      return DataType::domain;
    }
    if (!number) {
      note(ImportKind::assumed, object, entry, 0, "type-missing",
           "has no type; UNSIGNED32 is taken");
      return DataType::unsigned32;
    }
    if (const std::optional<DataType> type = data_type_of(*number)) {
      return *type;
    }
    note(ImportKind::repaired, object, entry, 0, "type-unknown",
         "has type " + hexadecimal_text(*number, 4) +
             "h, which is none of single values; OCTET_STRING is taken");
    return DataType::octet_string;
  }

  void declare_access(EntryDeclaration& row, const WrittenObject& object,
                      const WrittenEntry& entry) {
    const std::optional<EdsAccess> access = parse_access(entry.access.text);
    if (!access) {
      note(ImportKind::assumed, object, entry, entry.access.line,
           entry.access.text.empty() ? "access-missing" : "access-unknown",
           entry.access.text.empty()
               ? "does not say who may read and write it; both are allowed"
               : "has access " + quoted(entry.access.text) + ", which is none; both are allowed");
    }
    const EdsAccess allowed = access.value_or(EdsAccess{});
    row.access = allowed.access;
    row.mapping = mapping_of(allowed, object, entry);
  }

  PdoMapping mapping_of(const EdsAccess& allowed, const WrittenObject& object,
                        const WrittenEntry& entry) {
    if (entry.mapping == WrittenMapping::no) {
      return PdoMapping::no;
    }
    if (allowed.access == Access::constant) {
      note(ImportKind::repaired, object, entry, 0, "constant-mapped",
           "is constant, so that it is in no PDO whatever the file says");
      return PdoMapping::no;
    }
    if (entry.mapping == WrittenMapping::as_accessed) {
      return allowed.mappable;
    }
    const PdoMapping wanted =
        entry.mapping == WrittenMapping::receive ? PdoMapping::receive : PdoMapping::transmit;
    if (allowed.mappable == wanted || allowed.access == Access::read_write) {
      return wanted;
    }
    note(ImportKind::repaired, object, entry, 0, "mapping-contradicts-access",
         "is said to be in PDOs of a direction that its access does not allow; it is in none");
    return PdoMapping::no;
  }

  ImportNotes& notes_;
  dictionary::OwnedDeclarations declarations_;
};

/// The default of a numeric entry that the rows have, or nothing.
std::optional<std::uint64_t> declared_number(const dictionary::OwnedDeclarations& declarations,
                                             std::uint16_t index, std::uint8_t subindex) {
  const std::vector<EntryDeclaration>& rows = declarations.rows();
  const auto found = std::ranges::find_if(rows, [=](const EntryDeclaration& row) {
    return row.index == index && row.subindex == subindex;
  });
  return found != rows.end() && !is_string(found->type) && found->default_value.documented
             ? std::optional(found->default_value.number.bits)
             : std::nullopt;
}

}  // namespace

base::Expected<dictionary::OwnedDeclarations, dictionary::ImportError> declare_objects(
    const std::vector<WrittenObject>& objects, ImportNotes& notes) {
  return Declarer(notes).declare(objects);
}

std::uint32_t identity_number(const WrittenText& written, std::string_view what,
                              ImportNotes& notes) {
  if (written.text.empty()) {
    return 0;
  }
  const std::optional<EdsNumber> number = parse_eds_number(written.text);
  if (!number || number->node_id_relative || number->too_large ||
      number->bits > std::numeric_limits<std::uint32_t>::max()) {
    notes.add(ImportKind::left_out, written.line, "identity-unreadable",
              std::string(what) + " " + quoted(written.text) + " is no number of 32 bits");
    return 0;
  }
  return static_cast<std::uint32_t>(number->bits);
}

void complete_identity(EdsFile& file, ImportNotes& notes) {
  struct Part {
    std::uint32_t& number;
    std::string_view name;
    std::uint8_t subindex;
  };
  constexpr std::uint16_t kIdentity = 0x1018;
  for (const Part& part : {Part{file.vendor, "vendor", 1}, Part{file.code, "product", 2},
                           Part{file.revision, "revision", 3}}) {
    const std::optional<std::uint64_t> own =
        declared_number(file.objects, kIdentity, part.subindex);
    if (!own || *own == 0 || *own == part.number) {
      continue;
    }
    if (part.number == 0) {
      part.number = static_cast<std::uint32_t>(*own);
    } else {
      notes.add(ImportKind::known, 0, "identity-differs",
                "the file says that the " + std::string(part.name) + " is 0x" +
                    hexadecimal_text(part.number, 8) + ", but " +
                    entry_text(kIdentity, part.subindex) + " is 0x" + hexadecimal_text(*own, 8) +
                    "; each is as the file has it");
    }
  }
}

std::string entry_text(std::uint16_t index, std::uint8_t subindex) {
  return hexadecimal_text(index, 4) + "h:" + hexadecimal_text(subindex, 2);
}

std::string object_text(std::uint16_t index) {
  return hexadecimal_text(index, 4) + "h";
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  const bool longer = text.size() > kLongest;
  return "\"" + readable_text(text.substr(0, kLongest)) + (longer ? "...\"" : "\"");
}

}  // namespace stator::canopen
