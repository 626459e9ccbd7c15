#include "stator/devices/generic/completion.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "stator/devices/generic/hexadecimal.hpp"
#include "stator/ethercat/stack/pdo_configuration.hpp"

namespace stator::devices::generic {

namespace {

using dictionary::Access;
using dictionary::DataType;
using dictionary::EntryDeclaration;
using dictionary::hex;
using dictionary::ImportKind;
using dictionary::ImportReport;
using dictionary::ObjectCode;
using dictionary::PdoMapping;
using ethercat::ImportedPdo;
using ethercat::ImportedSlave;
using ethercat::PdoDirection;

constexpr unsigned kMostBits = 64;     // of a number
constexpr unsigned kLongestGap = 255;  // a mapping entry has one byte for the length
constexpr std::uint16_t kFirstRealIndex = 0x0020;
constexpr std::size_t kMostEntries = 254;

std::string address(unsigned index, unsigned subindex) {
  return hexadecimal(index, 4) + "h:" + hexadecimal(subindex, 2);
}

bool fits(DataType type, unsigned bits) {
  return dictionary::bit_length(type) == bits;
}

/// The rows of a slave by index and subindex.
class Rows {
 public:
  using Key = std::pair<std::uint16_t, std::uint8_t>;

  Rows(ImportedSlave& slave, ImportReport& report) : slave_(slave), report_(report) {
    for (const EntryDeclaration& row : slave.objects.rows()) {
      rows_.emplace(Key{row.index, row.subindex}, row);
    }
  }

  [[nodiscard]] EntryDeclaration* find(std::uint16_t index, std::uint8_t subindex) {
    const auto found = rows_.find({index, subindex});
    return found == rows_.end() ? nullptr : &found->second;
  }
  EntryDeclaration& put(const EntryDeclaration& row) {
    return rows_.insert_or_assign({row.index, row.subindex}, row).first->second;
  }
  [[nodiscard]] std::string_view keep(std::string text) {
    return slave_.objects.keep(std::move(text));
  }

  void map(const ImportedPdo& pdo, const ImportedPdo::Entry& entry, PdoDirection direction);
  void add_counts();
  void store();

 private:
  void add_mapped(const ImportedPdo::Entry& entry, PdoMapping mapping);

  ImportedSlave& slave_;
  ImportReport& report_;
  std::map<Key, EntryDeclaration> rows_;
};

PdoMapping mapping_of(PdoDirection direction) {
  return direction == PdoDirection::receive ? PdoMapping::receive : PdoMapping::transmit;
}

void Rows::add_mapped(const ImportedPdo::Entry& entry, PdoMapping mapping) {
  const DataType type =
      entry.type && fits(*entry.type, entry.bits) ? *entry.type : *unsigned_type(entry.bits);
  EntryDeclaration row{
      .index = entry.index,
      .subindex = entry.subindex,
      .name = keep(entry.name.empty() ? "Value" : entry.name),
      .object_code = entry.subindex == 0 ? ObjectCode::variable : ObjectCode::record,
      .type = type,
      .access = mapping == PdoMapping::receive ? Access::read_write : Access::read_only,
      .mapping = mapping};
  if (const EntryDeclaration* first = find(entry.index, 0);
      first != nullptr && entry.subindex != 0) {
    row.object_code =
        first->object_code == ObjectCode::variable ? ObjectCode::record : first->object_code;
  }
  put(row);
}

/// Has an object that the PDO can map.
void Rows::map(const ImportedPdo& pdo, const ImportedPdo::Entry& entry, PdoDirection direction) {
  const PdoMapping mapping = mapping_of(direction);
  EntryDeclaration* row = find(entry.index, entry.subindex);
  if (row == nullptr) {
    add_mapped(entry, mapping);
    if (slave_.objects.rows().empty()) {
      return;  // a file without a dictionary says it by its PDOs
    }
    report_.add(ImportKind::assumed, 0, "mapped-object-missing",
                hexadecimal(pdo.index, 4) + "h maps " + address(entry.index, entry.subindex) +
                    ", which the dictionary of the file has not; the device has it");
    return;
  }
  if (!fits(row->type, entry.bits)) {
    report_.add(ImportKind::repaired, 0, "mapped-length",
                hexadecimal(pdo.index, 4) + "h maps " + address(entry.index, entry.subindex) +
                    " with " + std::to_string(entry.bits) + " bits, its type has " +
                    std::to_string(dictionary::bit_length(row->type)) + "; the PDO counts");
    row->type =
        entry.type && fits(*entry.type, entry.bits) ? *entry.type : *unsigned_type(entry.bits);
    row->default_value = {};
    row->range.reset();
  }
  if (row->mapping != mapping && row->mapping != PdoMapping::both) {
    row->mapping = row->mapping == PdoMapping::no ? mapping : PdoMapping::both;
  }
}

/// Arrays and records without subindex 0 get one; an object has one code.
void Rows::add_counts() {
  std::map<std::uint16_t, std::uint8_t> highest;
  for (const auto& [key, row] : rows_) {
    highest[key.first] = std::max(highest[key.first], key.second);
  }
  for (const auto& [index, last] : highest) {
    EntryDeclaration* first = find(index, 0);
    if (last == 0) {
      if (first->object_code == ObjectCode::array || first->object_code == ObjectCode::record) {
        first->object_code = ObjectCode::variable;
        first->object_name = {};
      }
      continue;
    }
    if (first == nullptr) {
      const EntryDeclaration& any = rows_.lower_bound({index, 0})->second;
      first = &put({.index = index,
                    .subindex = 0,
                    .name = any.name,
                    .object_code = ObjectCode::record,
                    .type = DataType::unsigned8,
                    .access = Access::read_only,
                    .default_value = unsigned{last},
                    .object_name = any.name});
    }
    const ObjectCode code =
        first->object_code == ObjectCode::array ? ObjectCode::array : ObjectCode::record;
    if (first->object_name.empty()) {
      first->object_name = first->name;
    }
    for (auto row = rows_.lower_bound({index, 0}); row != rows_.upper_bound({index, 0xFF}); ++row) {
      row->second.object_code = code;
    }
  }
}

void Rows::store() {
  std::vector<EntryDeclaration>& stored = slave_.objects.rows();
  stored.clear();
  for (const auto& [key, row] : rows_) {
    stored.push_back(row);
  }
}

EntryDeclaration element(std::uint16_t index, std::uint8_t subindex, ObjectCode code, DataType type,
                         Access access, dictionary::Default value, std::string_view name) {
  return {.index = index,
          .subindex = subindex,
          .name = name,
          .object_code = code,
          .type = type,
          .access = access,
          .default_value = value};
}

/// The entries of a PDO that can stand there: gaps of 255 bits at most, no empty ones, nothing that
/// is no number.
std::vector<ImportedPdo::Entry> mappable(const ImportedPdo& pdo, ImportReport& report) {
  std::vector<ImportedPdo::Entry> entries;
  for (const ImportedPdo::Entry& entry : pdo.entries) {
    if (entry.bits == 0) {
      continue;
    }
    const bool number = entry.bits <= kMostBits && unsigned_type(entry.bits).has_value();
    const bool gap = entry.index < kFirstRealIndex;
    if (!gap && number) {
      entries.push_back(entry);
      continue;
    }
    if (!gap) {
      report.add(ImportKind::left_out, 0, "mapped-no-number",
                 hexadecimal(pdo.index, 4) + "h maps " + address(entry.index, entry.subindex) +
                     " with " + std::to_string(entry.bits) +
                     " bits, which is no number; its bits stay, nothing is behind them");
    }
    for (unsigned rest = entry.bits; rest != 0;) {
      const unsigned part = std::min(rest, kLongestGap);
      entries.push_back({.index = 0, .subindex = 0, .bits = static_cast<std::uint16_t>(part)});
      rest -= part;
    }
  }
  if (entries.size() > kMostEntries) {
    report.add(ImportKind::left_out, 0, "pdo-too-long",
               hexadecimal(pdo.index, 4) + "h has " + std::to_string(entries.size()) +
                   " entries; a mapping object takes 254, the rest is left out");
    entries.resize(kMostEntries);
  }
  return entries;
}

/// Sets what the entries of a mapping or assignment object hold by default. Rows that the file has
/// keep their names and access; what is behind `values` is 0.
void put_list(Rows& rows, std::span<const std::uint32_t> values, const EntryDeclaration& count,
              const EntryDeclaration& each, std::size_t room) {
  const auto set = [&](const EntryDeclaration& usual, std::uint8_t subindex,
                       dictionary::Default value) {
    EntryDeclaration* row = rows.find(usual.index, subindex);
    if (row == nullptr) {
      row = &rows.put(usual);
      row->subindex = subindex;
    }
    row->type = usual.type;
    row->default_value = value;
    row->range.reset();
  };
  set(count, 0, static_cast<unsigned>(values.size()));
  for (std::size_t i = 0; i < std::max(values.size(), room); ++i) {
    EntryDeclaration usual = each;
    usual.subindex = static_cast<std::uint8_t>(i + 1);
    set(usual, usual.subindex, hex(i < values.size() ? values[i] : 0U));
  }
}

/// Entries 1 to n of an object that the file has.
std::size_t listed(Rows& rows, std::uint16_t index) {
  std::size_t count = 0;
  while (count < kMostEntries &&
         rows.find(index, static_cast<std::uint8_t>(count + 1)) != nullptr) {
    ++count;
  }
  return count;
}

void add_mapping(Rows& rows, const ImportedPdo& pdo, PdoDirection direction, bool writable,
                 ImportReport& report) {
  const Access access = writable && !pdo.fixed ? Access::read_write : Access::read_only;
  const std::vector<ImportedPdo::Entry> entries = mappable(pdo, report);
  std::vector<std::uint32_t> values;
  for (const ImportedPdo::Entry& entry : entries) {
    const std::uint32_t value = std::uint32_t{entry.index} << 16 |
                                std::uint32_t{entry.subindex} << 8 | std::uint32_t{entry.bits};
    values.push_back(entry.index < kFirstRealIndex ? entry.bits : value);
  }
  const std::string_view name =
      pdo.name.empty() ? std::string_view("PDO mapping") : rows.keep(pdo.name);
  EntryDeclaration count =
      element(pdo.index, 0, ObjectCode::record, DataType::unsigned8, access, 0, name);
  count.object_name = name;
  put_list(
      rows, values, count,
      element(pdo.index, 1, ObjectCode::record, DataType::unsigned32, access, 0, "Mapped object"),
      listed(rows, pdo.index));
  for (const ImportedPdo::Entry& entry : entries) {
    if (entry.index >= kFirstRealIndex) {
      rows.map(pdo, entry, direction);
    }
  }
}

/// The sync manager that process data in one direction have.
std::optional<std::uint8_t> sync_manager_of(const ImportedSlave& slave, PdoDirection direction) {
  const std::uint8_t type =
      direction == PdoDirection::receive ? ethercat::kProcessOutputs : ethercat::kProcessInputs;
  for (std::size_t i = 0; i < slave.sync_managers.size(); ++i) {
    if (slave.sync_managers[i].type == type) {
      return static_cast<std::uint8_t>(i);
    }
  }
  return std::nullopt;
}

void add_assignment(Rows& rows, const ImportedSlave& slave, std::span<const ImportedPdo> pdos,
                    PdoDirection direction, ImportReport& report) {
  const std::uint16_t index = ethercat::assignment_object(direction);
  const std::string_view name = direction == PdoDirection::receive
                                    ? "Sync manager 2 PDO assignment"
                                    : "Sync manager 3 PDO assignment";
  std::vector<std::uint32_t> assigned;
  for (const ImportedPdo& pdo : pdos) {
    if (pdo.sync_manager || pdo.mandatory) {
      assigned.push_back(pdo.index);
    }
  }
  if (assigned.empty() && !pdos.empty() && sync_manager_of(slave, direction)) {
    assigned.push_back(pdos.front().index);
    report.add(ImportKind::assumed, 0, "no-default-pdo",
               "no PDO of this direction names a sync manager; " +
                   hexadecimal(pdos.front().index, 4) + "h, the first, is assigned");
  }
  const bool writable = slave.description.pdo_assign;
  const Access access = writable ? Access::read_write : Access::read_only;
  EntryDeclaration count =
      element(index, 0, ObjectCode::array, DataType::unsigned8, access, 0, name);
  count.object_name = name;
  // As many as the file's dictionary has, else one for each PDO.
  const std::size_t there = listed(rows, index);
  put_list(rows, assigned, count,
           element(index, 1, ObjectCode::array, DataType::unsigned16, access, 0, "Assigned PDO"),
           std::min(there != 0 || !writable ? there : pdos.size(), kMostEntries));
}

}  // namespace

std::optional<DataType> unsigned_type(unsigned bits) {
  using enum DataType;
  constexpr std::array kTypes{boolean,    bit2,       bit3,       bit4,       bit5,
                              bit6,       bit7,       unsigned8,  unsigned16, unsigned24,
                              unsigned32, unsigned40, unsigned48, unsigned56, unsigned64};
  const auto* const found = std::ranges::find_if(
      kTypes, [bits](DataType type) { return dictionary::bit_length(type) == bits; });
  return found == kTypes.end() ? std::nullopt : std::optional(*found);
}

void complete(ImportedSlave& slave, ImportReport& report) {
  Rows rows(slave, report);
  for (const PdoDirection direction : {PdoDirection::receive, PdoDirection::transmit}) {
    const std::vector<ImportedPdo>& pdos =
        direction == PdoDirection::receive ? slave.receive_pdos : slave.transmit_pdos;
    std::vector<ImportedPdo> usable;
    for (const ImportedPdo& pdo : pdos) {
      if (ethercat::pdo_direction(pdo.index) == direction) {
        usable.push_back(pdo);
        continue;
      }
      report.add(ImportKind::left_out, 0, "pdo-index",
                 "a PDO has the index " + hexadecimal(pdo.index, 4) +
                     "h, which is no mapping object of its direction");
    }
    for (const ImportedPdo& pdo : usable) {
      add_mapping(rows, pdo, direction, slave.description.pdo_configuration, report);
    }
    add_assignment(rows, slave, usable, direction, report);
  }
  rows.add_counts();
  rows.store();
}

}  // namespace stator::devices::generic
