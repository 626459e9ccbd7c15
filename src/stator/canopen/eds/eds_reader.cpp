// Reads electronic data sheets and device configuration files (CiA 306-1): which section says what.
#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "stator/base/spelling.hpp"
#include "stator/canopen/eds/eds_file.hpp"
#include "stator/canopen/eds/eds_lines.hpp"
#include "stator/canopen/eds/eds_objects.hpp"
#include "stator/canopen/eds/eds_section_role.hpp"
#include "stator/canopen/eds/eds_values.hpp"
#include "stator/canopen/eds/import_notes.hpp"

namespace stator::canopen {

namespace {

using base::same_word;
using dictionary::ImportError;
using dictionary::ImportKind;

std::optional<std::uint32_t> type_named(std::string_view name) {
  constexpr std::uint32_t kLastType = 0x1B;
  for (std::uint32_t number = 1; number <= kLastType; ++number) {
    const std::optional<dictionary::DataType> type = data_type_of(number);
    if (type && same_word(to_text(*type), name)) {
      return number;
    }
  }
  return std::nullopt;
}

/// Puts together what the sections of one file say.
class EdsReader {
 public:
  EdsReader(const EdsSections& sections, ImportNotes& notes) : sections_(sections), notes_(notes) {}

  base::Expected<EdsFile, ImportError> read() {
    for (const EdsSection& section : sections_) {
      take_section(section, role_of(section.name));
    }
    note_what_was_seen();
    check_lists();
    read_device();
    if (const EdsSection* dummies = find_section(sections_, "DummyUsage")) {
      file_.dummy_mapping = std::ranges::any_of(dummies->lines, [](const EdsLine& line) {
        return parse_flag(line.value.text).value_or(false);
      });
    }
    std::vector<WrittenObject> objects;
    objects.reserve(objects_.size());
    for (auto& [index, object] : objects_) {
      if (object.has_own || !object.entries.empty()) {
        objects.push_back(std::move(object));
      } else {
        notes_.add(ImportKind::left_out, object.own.line, "object-missing",
                   object_text(index) + ": has names or values of entries, but no description");
      }
    }
    auto declarations = declare_objects(objects, notes_);
    if (!declarations) {
      return base::Unexpected<ImportError>{declarations.error()};
    }
    file_.objects = std::move(*declarations);
    if (file_.objects.rows().empty()) {
      return base::Unexpected<ImportError>{
          {0, "no-objects", "the file describes no object; there is no device to be made of it"}};
    }
    complete_identity(file_, notes_);
    return std::move(file_);
  }

 private:
  // Sections of objects.

  void take_section(const EdsSection& section, const SectionRole& role) {
    switch (role.kind) {
      case SectionKind::object:
        take_object(section, object_of(role, section));
        break;
      case SectionKind::entry:
        take_entry(section, role, object_of(role, section));
        break;
      case SectionKind::compact_names:
        take_compact(section, object_of(role, section).compact_names);
        break;
      case SectionKind::compact_values:
        take_compact(section, object_of(role, section).compact_values);
        break;
      case SectionKind::commissioning:
        read_commissioning(section);
        break;
      case SectionKind::module:
        if (modules_++ == 0) {
          first_module_ = section.line;
        }
        break;
      case SectionKind::unknown:
        notes_.add(ImportKind::left_out, section.line, "section-unknown",
                   "nothing is known of section " + quoted(section.name));
        break;
      case SectionKind::about_object:
      case SectionKind::list:
      case SectionKind::general:
        break;
    }
  }

  WrittenObject& object_of(const SectionRole& role, const EdsSection& section) {
    WrittenObject& object = objects_[role.index];
    if (object.own.line == 0) {
      object.index = role.index;
      object.own.line = section.line;
    }
    return object;
  }

  void take_object(const EdsSection& section, WrittenObject& object) {
    if (object.has_own) {  // "[0x1000]" behind "[1000]"
      note_repeated(section);
      return;
    }
    object.has_own = true;
    object.own = entry_of(section, 0);
    object.sub_number = number_of(section, "SubNumber");
    if (const std::optional<std::uint32_t> compact = number_of(section, "CompactSubObj")) {
      constexpr std::uint32_t kMost = 0xFE;
      if (*compact > kMost) {
        notes_.add(ImportKind::repaired, section.line, "compact-beyond",
                   object_text(object.index) + ": has " + std::to_string(*compact) +
                       " entries by CompactSubObj; 254 are made");
      }
      object.compact = static_cast<std::uint8_t>(std::min(*compact, kMost));
    }
  }

  void take_entry(const EdsSection& section, const SectionRole& role, WrittenObject& object) {
    const auto same = [&role](const WrittenEntry& entry) {
      return entry.subindex == role.subindex;
    };
    if (std::ranges::any_of(object.entries, same)) {  // "[1018sub01]" behind "[1018sub1]"
      note_repeated(section);
      return;
    }
    object.entries.push_back(entry_of(section, role.subindex));
  }

  void take_compact(const EdsSection& section, std::map<std::uint8_t, WrittenText>& texts) {
    for (const EdsLine& line : section.lines) {
      const std::optional<EdsNumber> subindex = parse_eds_number(line.key);
      if (same_word(line.key, "NrOfEntries") || line.value.text.empty()) {
        continue;
      }
      if (!subindex || subindex->bits > std::numeric_limits<std::uint8_t>::max()) {
        notes_.add(ImportKind::left_out, line.value.line, "line-without-value",
                   quoted(line.key) + " is no subindex");
        continue;
      }
      texts.try_emplace(static_cast<std::uint8_t>(subindex->bits), line.value);
    }
  }

  void note_repeated(const EdsSection& section) {
    notes_.add(ImportKind::repaired, section.line, "section-repeated",
               "section " + quoted(section.name) +
                   " stands here again, spelt in another way; the first counts");
  }

  WrittenEntry entry_of(const EdsSection& section, std::uint8_t subindex) {
    WrittenEntry entry;
    entry.subindex = subindex;
    entry.line = section.line;
    entry.name = section.find("ParameterName");
    entry.object_type = number_of(section, "ObjectType");
    entry.data_type = type_of(section);
    entry.access = section.find("AccessType");
    entry.default_value = section.find("DefaultValue");
    entry.value = section.find("ParameterValue");
    entry.low_limit = section.find("LowLimit");
    entry.high_limit = section.find("HighLimit");
    entry.mapping =
        flag_of(section, "PDOMapping") ? WrittenMapping::as_accessed : WrittenMapping::no;
    if (!entry.value.text.empty()) {
      ++values_;
    }
    for (const std::string_view key : {"UploadFile", "DownloadFile"}) {
      if (const WrittenText file = section.find(key); !file.text.empty()) {
        notes_.add(ImportKind::left_out, file.line, "file-of-value",
                   "[" + readable_text(section.name) + "] has its value in the file " +
                       quoted(file.text) + ", which is not read");
      }
    }
    return entry;
  }

  std::optional<std::uint32_t> type_of(const EdsSection& section) {
    const WrittenText written = section.find("DataType");
    if (const std::optional<std::uint32_t> type = type_named(written.text)) {
      return type;
    }
    return number_of(section, "DataType");
  }

  std::optional<std::uint32_t> number_of(const EdsSection& section, std::string_view key) {
    const WrittenText written = section.find(key);
    if (written.text.empty()) {
      return std::nullopt;
    }
    const std::optional<EdsNumber> number = parse_eds_number(written.text);
    if (!number || number->node_id_relative || number->too_large ||
        number->bits > std::numeric_limits<std::uint32_t>::max()) {
      notes_.add(ImportKind::repaired, written.line, "number-unreadable",
                 "[" + readable_text(section.name) + "] has " + quoted(written.text) + " as " +
                     std::string(key) + ", which is no such number; it counts as missing");
      return std::nullopt;
    }
    return static_cast<std::uint32_t>(number->bits);
  }

  bool flag_of(const EdsSection& section, std::string_view key) {
    const WrittenText written = section.find(key);
    const std::optional<bool> flag = parse_flag(written.text);
    if (!flag) {
      notes_.add(ImportKind::repaired, written.line, "number-unreadable",
                 "[" + readable_text(section.name) + "] has " + quoted(written.text) + " as " +
                     readable_text(key) + ", which is neither 0 nor 1; 0 is taken");
    }
    return flag.value_or(false);
  }

  void note_what_was_seen() {
    if (modules_ > 0) {
      notes_.add(ImportKind::left_out, first_module_, "modules",
                 "sections that describe modules, of which the device has none: " +
                     std::to_string(modules_));
    }
    if (values_ > 0) {
      notes_.add(ImportKind::known, 0, "parameter-values",
                 "entries that start with their ParameterValue, not with the default: " +
                     std::to_string(values_));
    }
  }

  // Lists of objects.

  void check_lists() {
    std::map<std::uint16_t, std::size_t> listed;
    bool any = false;
    for (const EdsSection& section : sections_) {
      if (role_of(section.name).kind == SectionKind::list) {
        any = true;
        read_list(section, listed);
      }
    }
    if (!any) {
      notes_.add(ImportKind::repaired, 0, "lists-missing",
                 "no section lists the objects; all that are described count");
      return;
    }
    for (const auto& [index, line] : listed) {
      const auto found = objects_.find(index);
      if (found == objects_.end() || (!found->second.has_own && found->second.entries.empty())) {
        notes_.add(ImportKind::left_out, line, "section-missing",
                   object_text(index) + ": stands in a list, but no section describes it");
      }
    }
    for (const auto& [index, object] : objects_) {
      if (object.has_own && !listed.contains(index) && index >= 0x1000) {
        notes_.add(ImportKind::repaired, object.own.line, "object-unlisted",
                   object_text(index) + ": stands in no list; it counts nevertheless");
      }
    }
  }

  void read_list(const EdsSection& list, std::map<std::uint16_t, std::size_t>& listed) {
    std::size_t count = 0;
    for (const EdsLine& line : list.lines) {
      if (same_word(line.key, "SupportedObjects") || line.value.text.empty()) {
        continue;
      }
      ++count;
      if (const std::optional<std::uint16_t> index = listed_index(line)) {
        listed.try_emplace(*index, line.value.line);
      }
    }
    const WrittenText written = list.find("SupportedObjects");
    const std::optional<EdsNumber> said = parse_eds_number(written.text);
    if (said && said->bits != count) {
      notes_.add(ImportKind::repaired, written.line, "list-count",
                 "[" + readable_text(list.name) + "] should have " + quoted(written.text) +
                     " objects and has " + std::to_string(count));
    }
  }

  std::optional<std::uint16_t> listed_index(const EdsLine& line) {
    constexpr std::uint32_t kLast = std::numeric_limits<std::uint16_t>::max();
    const std::string_view text = line.value.text;
    const std::optional<EdsNumber> number = parse_eds_number(text);
    if (number && number->bits <= kLast &&
        (number->hexadecimal || objects_.contains(static_cast<std::uint16_t>(number->bits)))) {
      return static_cast<std::uint16_t>(number->bits);
    }
    // "1000" that means 1000h.
    const std::optional<std::uint32_t> index = parse_hexadecimal(text);
    if (index && *index <= kLast && objects_.contains(static_cast<std::uint16_t>(*index))) {
      notes_.add(ImportKind::repaired, line.value.line, "bare-hexadecimal",
                 quoted(text) + " is read as hexadecimal, which 0x should say");
      return static_cast<std::uint16_t>(*index);
    }
    if (number && number->bits <= kLast) {
      return static_cast<std::uint16_t>(number->bits);
    }
    notes_.add(ImportKind::left_out, line.value.line, "number-unreadable",
               quoted(text) + " is no index of an object");
    return std::nullopt;
  }

  // The device.

  void read_device() {
    const EdsSection* info = find_section(sections_, "DeviceInfo");
    if (info == nullptr) {
      notes_.add(ImportKind::assumed, 0, "device-info-missing",
                 "there is no section DeviceInfo; names and bit rates are not known");
      return;
    }
    file_.vendor_name = readable_text(info->find("VendorName").text);
    file_.product_name = readable_text(info->find("ProductName").text);
    file_.order_code = readable_text(info->find("OrderCode").text);
    file_.vendor = identity_number(info->find("VendorNumber"), "VendorNumber", notes_);
    file_.code = identity_number(info->find("ProductNumber"), "ProductNumber", notes_);
    file_.revision = identity_number(info->find("RevisionNumber"), "RevisionNumber", notes_);
    file_.lss = flag_of(*info, "LSS_Supported");
    if (flag_of(*info, "CompactPDO")) {
      notes_.add(ImportKind::left_out, info->find("CompactPDO").line, "compact-pdo",
                 "PDOs that are described by CompactPDO alone are not made");
    }
    constexpr std::size_t kMostBitRates = 32;
    for (const EdsLine& line : info->lines) {
      std::string_view rate = line.key;
      if (!take_beginning(rate, "BaudRate_") || !flag_of(*info, line.key)) {
        continue;
      }
      // BaudRate_auto names none.
      const std::optional<EdsNumber> kilobits = parse_eds_number(rate);
      if (kilobits && kilobits->bits <= 1000 && file_.bit_rates.size() < kMostBitRates) {
        file_.bit_rates.push_back(static_cast<std::uint32_t>(kilobits->bits * 1000));
      }
    }
    std::ranges::sort(file_.bit_rates);
  }

  /// What a configuration file says of the one device.
  void read_commissioning(const EdsSection& section) {
    if (const std::optional<std::uint32_t> id = number_of(section, "NodeID")) {
      if (*id >= 1 && *id <= 127) {
        file_.node_id = static_cast<std::uint8_t>(*id);
      } else {
        notes_.add(ImportKind::left_out, section.find("NodeID").line, "node-id",
                   std::to_string(*id) + " is no node-ID; those are 1 to 127");
      }
    }
    const std::optional<std::uint32_t> rate = number_of(section, "Baudrate");
    if (!rate || *rate == 0) {
      return;
    }
    const bool in_bits = *rate > 1000;
    if (in_bits) {
      notes_.add(ImportKind::repaired, section.find("Baudrate").line, "bit-rate",
                 std::to_string(*rate) + " kbit/s is faster than CAN; it is taken as bit/s");
    }
    file_.bit_rate = in_bits ? *rate : *rate * 1000;
  }

  const EdsSections& sections_;
  ImportNotes& notes_;
  std::map<std::uint16_t, WrittenObject> objects_;
  EdsFile file_;
  std::size_t modules_ = 0;
  std::size_t first_module_ = 0;
  std::size_t values_ = 0;
};

/// Sections alone make no data sheet of CANopen.
std::optional<ImportError> other_sections(const EdsSections& sections) {
  const bool known = std::ranges::any_of(sections, [](const EdsSection& section) {
    const SectionRole role = role_of(section.name);
    return role.about_an_object() || role.kind == SectionKind::list ||
           same_word(section.name, "FileInfo") || same_word(section.name, "DeviceInfo");
  });
  if (known) {
    return std::nullopt;
  }
  const bool industrial_protocol =
      find_section(sections, "File") != nullptr && find_section(sections, "Device") != nullptr;
  return ImportError{
      0, "not-eds",
      std::string("the file is no EDS or DCF (CiA 306-1): ") +
          (industrial_protocol ? "it looks like the EDS of an EtherNet/IP or DeviceNet device"
           : sections.empty()  ? "it has no section such as [DeviceInfo] or [1000]"
                               : "it has sections, but none such as [DeviceInfo] or [1000]")};
}

}  // namespace

base::Expected<EdsFile, ImportError> read_eds(std::string_view text,
                                              dictionary::ImportReport& report) {
  if (const std::optional<ImportError> error = other_format(text)) {
    return base::Unexpected<ImportError>{*error};
  }
  ImportNotes notes(report);
  const auto sections = split_eds(bare_text(text), notes);
  if (!sections) {
    return base::Unexpected<ImportError>{sections.error()};
  }
  if (const std::optional<ImportError> error = other_sections(*sections)) {
    return base::Unexpected<ImportError>{*error};
  }
  auto file = EdsReader(*sections, notes).read();
  notes.finish();
  return file;
}

}  // namespace stator::canopen
