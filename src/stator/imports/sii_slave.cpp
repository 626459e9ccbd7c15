#include "stator/imports/sii_slave.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/ethercat/units/sii_interface.hpp"
#include "stator/formats/esi/esi_encoding.hpp"

namespace stator::imports {

namespace {

using dictionary::ImportError;
using dictionary::ImportKind;
using dictionary::ImportReport;
using ethercat::ImportedPdo;
using ethercat::ImportedSlave;
using ethercat::SiiCategory;
using ethercat::SiiContents;
using Bytes = std::vector<std::byte>;

constexpr std::size_t kHeader = ethercat::sii_word::kFirstCategory * 2;
constexpr std::uint16_t kStringsType = static_cast<std::uint16_t>(SiiCategory::strings);
constexpr std::uint16_t kEndType = static_cast<std::uint16_t>(SiiCategory::end);

/// Of category 10: EEPROMs have these in whatever their maker's computer wrote.
std::string text_of(const std::string& bytes) {
  return formats::decode_esi(bytes).text;
}

void put_word(Bytes& bytes, std::uint16_t value) {
  bytes.push_back(static_cast<std::byte>(value & 0xFFU));
  bytes.push_back(static_cast<std::byte>(value >> 8));
}

/// The image with a right checksum, strings before whatever names by them, and an end.
Bytes in_order(std::span<const std::byte> image, ImportReport& report) {
  Bytes ordered(image.begin(), image.begin() + kHeader);
  const auto checksum = static_cast<std::byte>(ethercat::sii_checksum(ordered));
  constexpr std::size_t kChecksumByte = ethercat::sii_word::kChecksum * 2;
  if (ordered[kChecksumByte] != checksum) {
    report.add(ImportKind::repaired, 0, "sii-checksum",
               "the checksum of the first words is wrong; they are taken as they are");
    ordered[kChecksumByte] = checksum;
  }
  std::vector<std::pair<std::uint16_t, std::span<const std::byte>>> categories;
  std::size_t at = kHeader;
  while (at + 4 <= image.size()) {
    const auto type = base::load_le<std::uint16_t>(image, at);
    if (type == kEndType) {
      break;
    }
    const std::size_t length = std::size_t{base::load_le<std::uint16_t>(image, at + 2)} * 2;
    if (at + 4 + length > image.size()) {
      report.add(ImportKind::left_out, 0, "sii-category",
                 "category " + std::to_string(type) + " ends behind the image; it is left out");
      break;
    }
    categories.emplace_back(type, image.subspan(at + 4, length));
    at += 4 + length;
  }
  std::ranges::stable_sort(
      categories, {}, [](const auto& category) { return category.first == kStringsType ? 0 : 1; });
  for (const auto& [type, body] : categories) {
    put_word(ordered, type);
    put_word(ordered, static_cast<std::uint16_t>(body.size() / 2));
    ordered.insert(ordered.end(), body.begin(), body.end());
  }
  put_word(ordered, kEndType);
  put_word(ordered, kEndType);
  return ordered;
}

/// A data type of the standard's that the number names and that has so many bits.
std::optional<dictionary::DataType> type_of(std::uint8_t number, std::uint8_t bits) {
  const auto type = static_cast<dictionary::DataType>(number);
  return bits != 0 && dictionary::bit_length(type) == bits ? std::optional(type) : std::nullopt;
}

std::vector<ImportedPdo> pdos_of(const std::vector<ethercat::SiiPdo>& listed) {
  constexpr std::uint8_t kNotAssigned = 0x10;  // and above: no sync manager has such a number
  std::vector<ImportedPdo> pdos;
  for (const ethercat::SiiPdo& each : listed) {
    ImportedPdo pdo;
    pdo.index = each.index;
    pdo.name = text_of(each.name);
    if (each.sync_manager < kNotAssigned) {
      pdo.sync_manager = each.sync_manager;
    }
    for (const ethercat::SiiPdo::Entry& entry : each.entries) {
      pdo.entries.push_back({.index = entry.index,
                             .subindex = entry.subindex,
                             .bits = entry.bits,
                             .name = text_of(entry.name),
                             .type = type_of(entry.data_type, entry.bits)});
    }
    pdos.push_back(std::move(pdo));
  }
  return pdos;
}

/// What it does where its category does not say it: the direction is in the control byte.
std::uint8_t type_of(const ethercat::SiiSyncManager& manager) {
  constexpr unsigned kMailbox = 0x02;
  constexpr unsigned kMasterWrites = 0x04;
  if (manager.type != 0) {
    return manager.type;
  }
  if (manager.control == 0 && manager.start == 0) {
    return 0;
  }
  const bool writes = (manager.control & kMasterWrites) != 0;
  const bool mailbox = (manager.control & 0x03U) == kMailbox;
  if (mailbox) {
    return writes ? 1 : 2;
  }
  return writes ? 3 : 4;
}

}  // namespace

base::Expected<ImportedSlave, ImportError> slave_of_sii(std::span<const std::byte> image,
                                                        ImportReport& report) {
  if (image.size() < kHeader) {
    return base::Unexpected{ImportError{0, "sii-too-short",
                                        "an EEPROM image has 128 bytes at least, this one has " +
                                            std::to_string(image.size()) +
                                            "; read it again, e.g. with \"ethercat sii_read\""}};
  }
  const std::optional<SiiContents> contents = ethercat::parse_sii_image(in_order(image, report));
  if (!contents) {
    return base::Unexpected{ImportError{
        0, "sii-damaged", "a category of the image contradicts itself; read the EEPROM again"}};
  }
  ImportedSlave slave;
  ethercat::DeviceDescription& description = slave.description;
  description.vendor_id = contents->vendor_id;
  description.product_code = contents->product_code;
  description.revision = contents->revision;
  description.serial_number = contents->serial_number;
  description.station_alias = contents->station_alias;
  description.pdi_control = contents->pdi_control;
  description.pdi_configuration = static_cast<std::uint8_t>(contents->pdi_configuration);
  description.sync_latch_configuration =
      static_cast<std::uint8_t>(contents->pdi_configuration >> 8);
  description.sync_pulse_length = contents->sync_pulse_length;
  description.sii_size_kbit = contents->size_kbit;
  description.order_code = text_of(contents->order_code);
  description.name = contents->name.empty() ? description.order_code : text_of(contents->name);
  description.group = text_of(contents->group);
  description.receive_mailbox = contents->receive_mailbox;
  description.transmit_mailbox = contents->transmit_mailbox;
  constexpr unsigned kEoe = 0x02;
  constexpr unsigned kCoe = 0x04;
  constexpr unsigned kFoe = 0x08;
  const bool mailbox = contents->receive_mailbox.length != 0;
  description.coe = mailbox && (contents->mailbox_protocols & kCoe) != 0;
  description.eoe = mailbox && (contents->mailbox_protocols & kEoe) != 0;
  description.foe = mailbox && (contents->mailbox_protocols & kFoe) != 0;
  constexpr unsigned kInformation = 0x02;
  constexpr unsigned kAssign = 0x04;
  constexpr unsigned kConfigure = 0x08;
  constexpr unsigned kComplete = 0x20;
  description.sdo_information = (contents->coe_details & kInformation) != 0;
  description.pdo_assign = (contents->coe_details & kAssign) != 0;
  description.pdo_configuration = (contents->coe_details & kConfigure) != 0;
  description.complete_access = (contents->coe_details & kComplete) != 0;
  for (const ethercat::SiiSyncManager& manager : contents->sync_managers) {
    slave.sync_managers.push_back({.start = manager.start,
                                   .default_size = manager.length,
                                   .control = manager.control,
                                   .enabled = (manager.enable & 1U) != 0,
                                   .type = type_of(manager)});
  }
  slave.receive_pdos = pdos_of(contents->rx_pdos);
  slave.transmit_pdos = pdos_of(contents->tx_pdos);
  if (contents->distributed_clocks) {
    slave.clock_modes.push_back({.name = "DC", .assign_activate = 0x0300});
  }
  report.add(ImportKind::assumed, 0, "sii-no-dictionary",
             "an EEPROM has no object dictionary; the device has the objects of its PDOs");
  return slave;
}

}  // namespace stator::imports
