#include "stator/formats/esi/esi_pdos.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "stator/formats/esi/esi_values.hpp"

namespace stator::formats {

namespace {

using dictionary::EntryDeclaration;
using dictionary::ImportKind;
using dictionary::PdoMapping;
using ethercat::ImportedPdo;

constexpr std::size_t kMostPdos = 4096;
constexpr std::size_t kMostEntries = 254;  // mapped objects have subindices 1 to 254
constexpr std::size_t kMostExcluded = 255;
/// Indices of data types; with subindex 0 such an entry is a gap of the type's length (CiA 301
/// §7.4.9). Devices without mailbox have data at other subindices there, since nobody sees objects.
constexpr std::uint16_t kTypesEnd = 0x0020;

}  // namespace

void EsiPdos::add(pugi::xml_node parent, const EsiTypes& types, const EsiSlot& slot) {
  for (const pugi::xml_node element : parent.children("RxPdo")) {
    add_pdo(element, true, types, slot);
  }
  for (const pugi::xml_node element : parent.children("TxPdo")) {
    add_pdo(element, false, types, slot);
  }
}

void EsiPdos::add_pdo(pugi::xml_node element, bool receive, const EsiTypes& types,
                      const EsiSlot& slot) {
  if (visited_ == kMostPdos) {
    notes_.add(ImportKind::left_out, element, "too-many-pdos",
               fmt::format("a device has at most {} PDOs", kMostPdos));
    return;
  }
  ++visited_;
  const pugi::xml_node index_element = element.child("Index");
  const std::optional<std::uint16_t> index = slot.index_of(index_element);
  if (!index || *index == 0) {
    notes_.add(ImportKind::left_out, element, "pdo-index",
               fmt::format("\"{}\" is no index of a PDO", readable(index_element.child_value())));
    return;
  }
  const auto found = held_.find(*index);
  if (found != held_.end() && !(slot.module && found->second.overwritable)) {
    notes_.add(ImportKind::left_out, element, "pdo-twice",
               fmt::format("PDO {:04X}h is there again; the first counts", *index));
    return;
  }
  Held held;
  held.element = element;
  held.receive = receive;
  held.overwritable =
      !slot.module && esi_truth(attribute_text(index_element, "OverwrittenByModule"), false);
  ImportedPdo& pdo = held.pdo;
  pdo.index = *index;
  pdo.name = esi_name(element);
  pdo.fixed = esi_truth(attribute_text(element, "Fixed"), false);
  pdo.mandatory = esi_truth(attribute_text(element, "Mandatory"), false);
  if (const std::string_view number = attribute_text(element, "Sm"); !number.empty()) {
    constexpr std::uint64_t kLastSyncManager = 15;
    const auto sync_manager = esi_number_up_to(number, kLastSyncManager);
    if (sync_manager) {
      pdo.sync_manager = static_cast<std::uint8_t>(*sync_manager);
    } else {
      notes_.add(ImportKind::left_out, element, "pdo-sync-manager",
                 fmt::format("\"{}\" is no sync manager; PDO {:04X}h is assigned to none",
                             readable(number), *index));
    }
  }
  add_excluded(element, slot, pdo);
  for (const pugi::xml_node entry : element.children("Entry")) {
    add_entry(entry, types, slot, pdo);
  }
  if (found != held_.end()) {
    found->second = std::move(held);
    return;
  }
  order_.push_back(*index);
  held_.emplace(*index, std::move(held));
}

void EsiPdos::add_excluded(pugi::xml_node element, const EsiSlot& slot, ImportedPdo& pdo) {
  for (const pugi::xml_node exclude : element.children("Exclude")) {
    const std::optional<std::uint16_t> other = slot.index_of(exclude);
    if (!other) {
      notes_.add(ImportKind::left_out, exclude, "pdo-exclude",
                 fmt::format("\"{}\" is no index of a PDO", readable(exclude.child_value())));
    } else if (*other != pdo.index && pdo.excluded.size() < kMostExcluded) {
      pdo.excluded.push_back(*other);
    }
  }
}

void EsiPdos::add_entry(pugi::xml_node element, const EsiTypes& types, const EsiSlot& slot,
                        ImportedPdo& pdo) {
  constexpr std::uint64_t kLongest = 0xFFFF;
  if (pdo.entries.size() == kMostEntries) {
    notes_.add(
        ImportKind::left_out, element, "too-many-mapped",
        fmt::format("PDO {:04X}h: at most {} objects can be mapped", pdo.index, kMostEntries));
    return;
  }
  const pugi::xml_node index_element = element.child("Index");
  const std::string_view written = trimmed(index_element.child_value());
  std::optional<std::uint16_t> index = slot.index_of(index_element);
  if (!index && written.empty()) {
    index = std::uint16_t{0};
  }
  const std::string_view type_name = child_text(element, "DataType");
  const std::optional<EsiType> type =
      types.known(type_name, esi_bits(child_text(element, "BitLen")));
  const std::string_view length = child_text(element, "BitLen");
  std::optional<std::uint64_t> bits = esi_number_up_to(length, kLongest);
  if (!bits && length.empty() && type && type->bits != 0 && type->bits <= kLongest) {
    bits = type->bits;
    notes_.add(ImportKind::assumed, element, "entry-length",
               fmt::format("an entry of PDO {:04X}h has no length; its type has {} bits", pdo.index,
                           *bits));
  }
  if (!index || !bits) {
    notes_.add(ImportKind::left_out, element, "pdo-entry",
               fmt::format("an entry of PDO {:04X}h has index \"{}\" and length \"{}\", which "
                           "cannot be",
                           pdo.index, readable(written), readable(length)));
    return;
  }
  if (*index == pdo.index) {
    notes_.add(ImportKind::repaired, element, "pdo-maps-itself",
               fmt::format("PDO {:04X}h maps itself; this entry is left out", pdo.index));
    return;
  }
  const std::string_view sub = child_text(element, "SubIndex");
  const auto subindex = esi_number_up_to(sub, kHighestSubindex);
  if (!subindex && !sub.empty() && *index != 0) {
    notes_.add(
        ImportKind::left_out, element, "pdo-entry",
        fmt::format("an entry of PDO {:04X}h has subindex \"{}\"", pdo.index, readable(sub)));
    return;
  }
  ImportedPdo::Entry entry;
  entry.bits = static_cast<std::uint16_t>(*bits);
  if (*index == 0 || (*index < kTypesEnd && subindex.value_or(0) == 0)) {  // a gap
    if (*index != 0) {
      notes_.add(ImportKind::repaired, element, "type-mapped",
                 fmt::format("PDO {:04X}h maps {:04X}h, which is a data type; it is a gap of {} "
                             "bits",
                             pdo.index, *index, *bits));
    }
    pdo.entries.push_back(std::move(entry));
    return;
  }
  entry.index = *index;
  entry.subindex = static_cast<std::uint8_t>(subindex.value_or(0));
  entry.name = esi_name(element);
  if (type && type->bits == entry.bits) {
    entry.type = type->type;
  } else if (type) {
    notes_.add(
        ImportKind::repaired, element, "entry-length",
        fmt::format("PDO {:04X}h maps {:04X}h:{:02X} with {} bits, which {} does not have; "
                    "the bits count",
                    pdo.index, entry.index, entry.subindex, entry.bits, readable(type_name)));
  }
  pdo.entries.push_back(std::move(entry));
}

/// Of PDOs that exclude one another only the first is assigned by default; many files name a sync
/// manager for all.
void EsiPdos::keep_assignable(std::vector<Held*>& order) {
  std::set<std::uint16_t> assigned;
  std::set<std::uint16_t> excluded;
  for (const bool mandatory : {true, false}) {  // who must be assigned comes before who may
    for (Held* const held : order) {
      ImportedPdo& pdo = held->pdo;
      if (!pdo.sync_manager || pdo.mandatory != mandatory) {
        continue;
      }
      const bool clash =
          excluded.contains(pdo.index) ||
          std::ranges::any_of(pdo.excluded, [&](std::uint16_t i) { return assigned.contains(i); });
      if (clash) {
        notes_.add(ImportKind::repaired, held->element, "pdo-excluded",
                   fmt::format("PDO {:04X}h has a sync manager, as has one that excludes it; it is "
                               "not assigned by default",
                               pdo.index));
        pdo.sync_manager.reset();
        continue;
      }
      assigned.insert(pdo.index);
      excluded.insert(pdo.excluded.begin(), pdo.excluded.end());
    }
  }
}

/// What the file's PDOs map can be mapped, whatever the flags of the object say.
void EsiPdos::let_be_mapped(const Held& held, EsiDictionary& dictionary) {
  const PdoMapping wanted = held.receive ? PdoMapping::receive : PdoMapping::transmit;
  for (const ImportedPdo::Entry& entry : held.pdo.entries) {
    EntryDeclaration* const row =
        entry.index == 0 ? nullptr : dictionary.find(entry.index, entry.subindex);
    if (row == nullptr || row->mapping == wanted || row->mapping == PdoMapping::both) {
      continue;
    }
    row->mapping = row->mapping == PdoMapping::no ? wanted : PdoMapping::both;
    notes_.add(ImportKind::repaired, held.element, "mapping-flag",
               fmt::format("PDO {:04X}h maps {:04X}h:{:02X}, whose flags do not allow it; it can "
                           "be mapped",
                           held.pdo.index, entry.index, entry.subindex));
  }
}

void EsiPdos::finish(ethercat::ImportedSlave& slave, EsiDictionary& dictionary) {
  std::vector<Held*> order;
  for (const std::uint16_t index : order_) {
    order.push_back(&held_.at(index));
  }
  keep_assignable(order);
  for (Held* const held : order) {
    let_be_mapped(*held, dictionary);
    std::vector<ImportedPdo>& pdos = held->receive ? slave.receive_pdos : slave.transmit_pdos;
    pdos.push_back(std::move(held->pdo));
  }
}

}  // namespace stator::formats
