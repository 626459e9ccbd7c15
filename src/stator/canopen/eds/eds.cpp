#include "stator/canopen/eds/eds.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <vector>

namespace stator::canopen {

namespace {

using dictionary::Access;
using dictionary::DataType;
using dictionary::Entry;
using dictionary::EntryDeclaration;
using dictionary::Object;
using dictionary::ObjectCode;
using dictionary::PdoMapping;

std::string hexadecimal(std::uint64_t value, std::size_t digits) {
  std::string text;
  while (value != 0 || text.size() < digits) {
    text.insert(text.begin(), "0123456789ABCDEF"[value & 0xF]);
    value >>= 4;
  }
  return text;
}

std::string with_prefix(std::uint64_t value, std::size_t digits) {
  return "0x" + hexadecimal(value, digits);
}

/// Sections of "Key=Value" lines.
class EdsWriter {
 public:
  void section(std::string_view name) {
    if (!text_.empty()) {
      end_line();
    }
    text_ += '[';
    text_ += name;
    text_ += ']';
    end_line();
  }
  void line(std::string_view key, std::string_view value) {
    text_ += key;
    text_ += '=';
    text_ += value;
    end_line();
  }
  void line(std::string_view key, std::uint64_t value) { line(key, std::to_string(value)); }
  void flag(std::string_view key, bool value) { line(key, value ? "1" : "0"); }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  void end_line() { text_ += "\r\n"; }
  std::string text_;
};

std::string number_text(DataType type, std::uint64_t bits) {
  return dictionary::is_signed(type) ? std::to_string(static_cast<std::int64_t>(bits))
                                     : std::to_string(bits);
}

/// As CiA 306-1 §4.6.3.2 spells it: rwr and rww say which way an entry may be mapped.
std::string_view access_text(const EntryDeclaration& declaration) {
  switch (declaration.access) {
    case Access::read_only:
      return "ro";
    case Access::write_only:
      return "wo";
    case Access::constant:
      return "const";
    case Access::read_write:
      break;
  }
  switch (declaration.mapping) {
    case PdoMapping::transmit:
      return "rwr";
    case PdoMapping::receive:
      return "rww";
    case PdoMapping::no:
    case PdoMapping::both:
      break;
  }
  return "rw";
}

/// Empty if no value is to be expected after a reset.
std::string default_text(const Entry& entry) {
  const EntryDeclaration& declaration = entry.declaration();
  if (declaration.live || !declaration.default_value.documented || !entry.readable()) {
    return {};
  }
  if (is_string(entry.type())) {
    return entry.type() == DataType::domain ? std::string()
                                            : std::string(declaration.default_value.text);
  }
  if (declaration.node_id_relative) {
    return "$NODEID+" + with_prefix(declaration.default_value.number.bits, 1);
  }
  if (declaration.default_value.number.hexadecimal) {
    return with_prefix(entry.default_bits(), 2 * byte_length(entry.type()));
  }
  return number_text(entry.type(), entry.default_bits());
}

struct Limits {
  std::string low;
  std::string high;
};

/// The values a write may have, empty where every value of the type may be written.
Limits limits(const Entry& entry) {
  const EntryDeclaration& declaration = entry.declaration();
  if (!entry.writable() || is_string(entry.type())) {
    return {};
  }
  if (!declaration.legal_values.empty()) {
    const auto [low, high] = std::ranges::minmax_element(declaration.legal_values);
    return {std::to_string(*low), std::to_string(*high)};
  }
  const std::size_t bits = bit_length(entry.type());
  if (!declaration.range || bits == 64) {
    return {};
  }
  const auto low = declaration.range->minimum.as_signed();
  const auto high = declaration.range->maximum.as_signed();
  const std::int64_t span = std::int64_t{1} << bits;
  const std::int64_t lowest = is_signed(entry.type()) ? -span / 2 : 0;
  if (low == lowest && high == lowest + span - 1) {
    return {};
  }
  return {std::to_string(low), std::to_string(high)};
}

void write_entry(EdsWriter& eds, const Entry& entry, std::string_view name) {
  eds.line("ParameterName", name);
  eds.line("ObjectType", "0x7");
  eds.line("DataType", with_prefix(static_cast<std::uint64_t>(entry.type()), 4));
  eds.line("AccessType", access_text(entry.declaration()));
  if (const Limits allowed = limits(entry); !allowed.low.empty()) {
    eds.line("LowLimit", allowed.low);
    eds.line("HighLimit", allowed.high);
  }
  if (const std::string value = default_text(entry); !value.empty()) {
    eds.line("DefaultValue", value);
  }
  eds.flag("PDOMapping", entry.declaration().mapping != PdoMapping::no);
}

class Names {
 public:
  /// `name`, with the index behind it if another object has it already.
  std::string unique(const Object& object) {
    if (used_.insert(object.name.str()).second) {
      return object.name.str();
    }
    std::string name = object.name.str() + " (" + hexadecimal(object.index, 4) + "h)";
    used_.insert(name);
    return name;
  }

 private:
  std::set<std::string> used_;
};

void write_object(EdsWriter& eds, const Object& object, const std::string& name) {
  const std::string index = hexadecimal(object.index, 4);
  eds.section(index);
  if (object.code == ObjectCode::variable) {
    write_entry(eds, object.entries.front(), name);
    return;
  }
  eds.line("ParameterName", name);
  eds.line("ObjectType", with_prefix(static_cast<std::uint64_t>(object.code), 1));
  eds.line("SubNumber", object.entries.size());
  for (const Entry& entry : object.entries) {
    eds.section(index + "sub" + hexadecimal(entry.subindex(), 1));
    write_entry(eds, entry, entry.name());
  }
}

enum class Group : std::uint8_t { mandatory, optional, manufacturer };

/// CiA 306-1 §4.6.2.
Group group_of(std::uint16_t index) {
  if (index == 0x1000 || index == 0x1001 || index == 0x1018) {
    return Group::mandatory;
  }
  return index >= 0x2000 && index <= 0x5FFF ? Group::manufacturer : Group::optional;
}

constexpr std::array kGroups{std::pair{Group::mandatory, "MandatoryObjects"},
                             std::pair{Group::optional, "OptionalObjects"},
                             std::pair{Group::manufacturer, "ManufacturerObjects"}};

void write_objects(EdsWriter& eds, const dictionary::Dictionary& dictionary) {
  Names names;
  std::vector<std::string> unique;
  for (const Object& object : dictionary.objects()) {
    unique.push_back(names.unique(object));
  }
  const std::span<const Object> objects = dictionary.objects();
  for (const auto& [group, section] : kGroups) {
    eds.section(section);
    std::vector<std::size_t> members;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (group_of(objects[i].index) == group) {
        members.push_back(i);
      }
    }
    eds.line("SupportedObjects", members.size());
    for (std::size_t i = 0; i < members.size(); ++i) {
      eds.line(std::to_string(i + 1), with_prefix(objects[members[i]].index, 4));
    }
    for (const std::size_t member : members) {
      write_object(eds, objects[member], unique[member]);
    }
  }
}

void write_file_info(EdsWriter& eds, const EdsDescription& description) {
  eds.section("FileInfo");
  eds.line("FileName", description.file_name);
  eds.line("FileVersion", "1");
  eds.line("FileRevision", "1");
  eds.line("EDSVersion", "4.0");
  eds.line("Description", description.title);
  eds.line("CreationTime", description.time);
  eds.line("CreationDate", description.date);
  eds.line("CreatedBy", description.author);
  eds.line("ModificationTime", description.time);
  eds.line("ModificationDate", description.date);
  eds.line("ModifiedBy", description.author);
}

std::uint64_t pdo_count(const dictionary::Dictionary& dictionary, unsigned first) {
  return static_cast<std::uint64_t>(
      std::ranges::count_if(dictionary.objects(), [first](const Object& object) {
        return object.index >= first && object.index < first + 0x200;
      }));
}

void write_device_info(EdsWriter& eds, const dictionary::Dictionary& dictionary,
                       const EdsDescription& description) {
  const auto identity = [&dictionary](std::uint8_t subindex) {
    const Entry* entry = dictionary.find(0x1018, subindex);
    return with_prefix(entry == nullptr ? 0 : entry->default_bits(), 8);
  };
  eds.section("DeviceInfo");
  eds.line("VendorName", description.vendor_name);
  eds.line("VendorNumber", identity(1));
  eds.line("ProductName", description.product_name);
  eds.line("ProductNumber", identity(2));
  eds.line("RevisionNumber", identity(3));
  eds.line("OrderCode", description.order_code);
  for (const int rate : {10, 20, 50, 125, 250, 500, 800, 1000}) {
    eds.flag("BaudRate_" + std::to_string(rate),
             std::ranges::find(description.bit_rates, rate) != description.bit_rates.end());
  }
  eds.line("SimpleBootUpMaster", "0");
  eds.line("SimpleBootUpSlave", "1");
  eds.line("Granularity", "8");
  eds.line("DynamicChannelsSupported", "0");
  eds.line("GroupMessaging", "0");
  eds.line("NrOfRXPDO", pdo_count(dictionary, 0x1400));
  eds.line("NrOfTXPDO", pdo_count(dictionary, 0x1800));
  eds.flag("LSS_Supported", description.lss);
}

}  // namespace

std::string eds_text(const dictionary::Dictionary& dictionary, const EdsDescription& description) {
  EdsWriter eds;
  write_file_info(eds, description);
  write_device_info(eds, dictionary, description);
  eds.section("DummyUsage");
  for (const char* type : {"Dummy0001", "Dummy0002", "Dummy0003", "Dummy0004", "Dummy0005",
                           "Dummy0006", "Dummy0007"}) {
    eds.flag(type, description.dummy_mapping);
  }
  eds.section("Comments");
  eds.line("Lines", description.comments.size());
  for (std::size_t i = 0; i < description.comments.size(); ++i) {
    eds.line("Line" + std::to_string(i + 1), description.comments[i]);
  }
  write_objects(eds, dictionary);
  return eds.take();
}

namespace {
constexpr auto kEdsObjects = std::to_array<EntryDeclaration>({
    {.index = 0x1021,
     .name = "Store EDS",
     .type = DataType::domain,
     .access = Access::read_only,
     .source = "CiA 301 7.5.2.20",
     .note = "Not an object of the product's document: the electronic data sheet as text."},
    {.index = 0x1022,
     .name = "Store format",
     .type = DataType::unsigned16,
     .access = Access::read_only,
     .default_value = 0,
     .range = dictionary::Range{0, 65535},
     .source = "CiA 301 7.5.2.21",
     .note = "Not an object of the product's document: 0 = text, not compressed."},
});
}  // namespace

void add_eds_objects(dictionary::Dictionary& dictionary) {
  dictionary.add(kEdsObjects);
}

void store_eds(dictionary::Dictionary& dictionary, std::string_view text) {
  dictionary.find(0x1021, 0)->set_text(text);
}

}  // namespace stator::canopen
