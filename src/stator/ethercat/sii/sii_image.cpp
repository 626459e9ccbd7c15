#include "stator/ethercat/sii/sii_image.hpp"

#include <algorithm>
#include <stdexcept>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/sii/sii_writer.hpp"
#include "stator/ethercat/stack/pdo_configuration.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/ethercat/units/sii_interface.hpp"

namespace stator::ethercat {

namespace {

using dictionary::Dictionary;
using dictionary::Entry;
using dictionary::Object;
using Writer = SiiWriter;
using StringTable = SiiStringTable;

// Bits of the mailbox protocols word.
constexpr unsigned kProtocolEoe = 0x02;
constexpr unsigned kProtocolCoe = 0x04;
constexpr unsigned kProtocolFoe = 0x08;

// Bits of the CoE details byte.
constexpr unsigned kCoeSdo = 0x01;
constexpr unsigned kCoeSdoInformation = 0x02;
constexpr unsigned kCoePdoAssign = 0x04;
constexpr unsigned kCoePdoConfiguration = 0x08;
constexpr unsigned kCoeCompleteAccess = 0x20;

// Bits of the general category's flags byte.
constexpr unsigned kFlagMailboxRepeat = 0x04;
constexpr unsigned kFlagIdentification = 0x08;

// Sync manager control bytes: buffer mode, direction, host interrupt, watchdog trigger.
constexpr std::uint8_t kReceiveMailboxControl = 0x26;
constexpr std::uint8_t kTransmitMailboxControl = 0x22;
constexpr std::uint8_t kOutputControl = 0x64;
constexpr std::uint8_t kInputControl = 0x20;

constexpr std::uint8_t kFmmuOutputs = 1;
constexpr std::uint8_t kFmmuInputs = 2;
constexpr std::uint8_t kFmmuMailboxState = 3;
constexpr std::uint8_t kFmmuUnused = 0xFF;

constexpr std::uint8_t kNotAssigned = 0xFF;

/// Value of an entry as after power-on.
std::uint64_t default_of(const Object& object, std::uint8_t subindex) {
  const Entry* entry = object.find(subindex);
  return entry == nullptr ? 0 : entry->default_bits();
}

/// The sync manager that carries `pdo` by default, or kNotAssigned.
std::uint8_t default_sync_manager(const Dictionary& dictionary, std::uint16_t pdo,
                                  PdoDirection direction) {
  const Object* assignment = dictionary.find(assignment_object(direction));
  if (assignment != nullptr) {
    const std::uint64_t count = default_of(*assignment, 0);
    for (const Entry& entry : assignment->entries.subspan(1)) {
      if (entry.subindex() <= count && entry.default_bits() == pdo) {
        return direction == PdoDirection::receive ? 2 : 3;
      }
    }
  }
  return kNotAssigned;
}

Writer pdo_category(const Dictionary& dictionary, PdoDirection direction, StringTable& strings) {
  Writer body;
  for (const Object& pdo : dictionary.objects()) {
    if (pdo_direction(pdo.index) != direction) {
      continue;
    }
    const std::uint64_t count = default_of(pdo, 0);
    body.put(pdo.index);
    body.put(static_cast<std::uint8_t>(count));
    body.put(default_sync_manager(dictionary, pdo.index, direction));
    body.put(std::uint8_t{0});  // synchronization
    body.put(strings.number(pdo.name.str()));
    body.put(std::uint16_t{0});  // flags
    for (const Entry& source : pdo.entries.subspan(1)) {
      if (source.subindex() > count) {
        break;
      }
      const MappingEntry mapping = MappingEntry::decode(source.default_bits());
      const Entry* mapped = dictionary.find(mapping.index, mapping.subindex);
      body.put(mapping.index);
      body.put(mapping.subindex);
      body.put(strings.number(mapped == nullptr ? std::string_view{} : mapped->name()));
      body.put(
          static_cast<std::uint8_t>(mapped == nullptr ? 0 : static_cast<unsigned>(mapped->type())));
      body.put(mapping.bits);
      body.put(std::uint16_t{0});  // flags
    }
  }
  return body;
}

/// Bytes that the default assignment maps.
std::uint16_t default_length(const Dictionary& dictionary, PdoDirection direction) {
  std::size_t bits = 0;
  for (const Object& pdo : dictionary.objects()) {
    if (pdo_direction(pdo.index) == direction &&
        default_sync_manager(dictionary, pdo.index, direction) != kNotAssigned) {
      const std::uint64_t count = default_of(pdo, 0);
      for (const Entry& source : pdo.entries.subspan(1)) {
        bits += source.subindex() <= count ? MappingEntry::decode(source.default_bits()).bits : 0;
      }
    }
  }
  return static_cast<std::uint16_t>((bits + 7) / 8);
}

unsigned port_code(char physics) {
  switch (physics) {
    case 'Y':
      return 1;  // MII
    case 'K':
      return 3;  // E-bus
    default:
      return 0;
  }
}

Writer general_category(const DeviceDescription& description, const SiiOptions& options,
                        StringTable& strings) {
  const std::uint8_t group = strings.number(description.group);
  unsigned coe = 0;
  if (description.coe) {
    coe |= kCoeSdo;
    coe |= description.sdo_information ? kCoeSdoInformation : 0;
    coe |= description.pdo_assign ? kCoePdoAssign : 0;
    coe |= description.pdo_configuration ? kCoePdoConfiguration : 0;
    coe |= description.complete_access ? kCoeCompleteAccess : 0;
  }
  unsigned ports = 0;
  for (std::size_t port = 0; port < description.port_physics.size(); ++port) {
    ports |= port_code(description.port_physics[port]) << (4 * port);
  }
  const bool mailbox = description.receive_mailbox.length != 0;
  Writer body;
  body.put(group);
  body.put(strings.number(description.image));
  body.put(strings.number(description.order_code));
  body.put(strings.number(description.name));
  body.put(std::uint8_t{0});
  body.put(static_cast<std::uint8_t>(coe));
  body.put(static_cast<std::uint8_t>(description.foe ? 1 : 0));
  body.put(static_cast<std::uint8_t>(description.eoe ? 1 : 0));
  body.put(std::uint8_t{0});  // SoE channels
  body.put(std::uint8_t{0});  // DS402 channels
  body.put(std::uint8_t{0});  // system manager class
  body.put(static_cast<std::uint8_t>((mailbox ? kFlagMailboxRepeat : 0U) |
                                     (options.device_identification ? kFlagIdentification : 0U)));
  body.put(description.ebus_current);
  body.put(group);
  body.put(std::uint8_t{0});
  body.put(static_cast<std::uint16_t>(ports));
  body.put(options.device_identification ? register_address::kAlStatusCode : std::uint16_t{0});
  body.bytes().resize(32);
  return body;
}

Writer fmmu_category(const DeviceDescription& description) {
  Writer body;
  const bool mailbox = description.receive_mailbox.length != 0;
  body.put(kFmmuOutputs);
  body.put(kFmmuInputs);
  body.put(mailbox ? kFmmuMailboxState : kFmmuUnused);
  body.put(kFmmuUnused);
  return body;
}

Writer sync_manager_category(const DeviceDescription& description, const Dictionary& dictionary) {
  Writer body;
  const auto put = [&](std::uint16_t start, std::uint16_t length, std::uint8_t control,
                       std::uint8_t type) {
    body.put(start);
    body.put(length);
    body.put(control);
    body.put(std::uint8_t{0});  // status
    body.put(static_cast<std::uint8_t>(length != 0 ? 1 : 0));
    body.put(type);
  };
  put(description.receive_mailbox.offset, description.receive_mailbox.length,
      kReceiveMailboxControl, 1);
  put(description.transmit_mailbox.offset, description.transmit_mailbox.length,
      kTransmitMailboxControl, 2);
  put(description.output_offset, default_length(dictionary, PdoDirection::receive), kOutputControl,
      3);
  put(description.input_offset, default_length(dictionary, PdoDirection::transmit), kInputControl,
      4);
  return body;
}

void store_mailbox(std::span<std::byte> image, std::size_t word, const MailboxArea& receive,
                   const MailboxArea& transmit) {
  base::store_le(image, word * 2, receive.offset);
  base::store_le(image, word * 2 + 2, receive.length);
  base::store_le(image, word * 2 + 4, transmit.offset);
  base::store_le(image, word * 2 + 6, transmit.length);
}

void store_fixed_part(std::span<std::byte> image, const DeviceDescription& description) {
  using namespace sii_word;
  const unsigned protocols = (description.eoe ? kProtocolEoe : 0U) |
                             (description.coe ? kProtocolCoe : 0U) |
                             (description.foe ? kProtocolFoe : 0U);
  base::store_le(image, kPdiControl * 2, description.pdi_control);
  image[kPdiConfiguration * 2] = std::byte{description.pdi_configuration};
  image[kPdiConfiguration * 2 + 1] = std::byte{description.sync_latch_configuration};
  base::store_le(image, kSyncPulseLength * 2, description.sync_pulse_length);
  base::store_le(image, kStationAlias * 2, description.station_alias);
  base::store_le(image, kChecksum * 2, std::uint16_t{sii_checksum(image)});
  base::store_le(image, kVendorId * 2, description.vendor_id);
  base::store_le(image, kProductCode * 2, description.product_code);
  base::store_le(image, kRevision * 2, description.revision);
  base::store_le(image, kSerialNumber * 2, description.serial_number);
  store_mailbox(image, kBootstrapMailbox, description.bootstrap_receive_mailbox,
                description.bootstrap_transmit_mailbox);
  store_mailbox(image, kStandardMailbox, description.receive_mailbox, description.transmit_mailbox);
  base::store_le(image, kMailboxProtocols * 2, static_cast<std::uint16_t>(protocols));
  base::store_le(image, kVersion * 2, std::uint16_t{1});
}

}  // namespace

std::vector<std::byte> build_sii_image(const DeviceDescription& description,
                                       const Dictionary& dictionary, const SiiOptions& options) {
  StringTable strings;
  strings.number(description.name);  // masters print string 1
  const Writer general = general_category(description, options, strings);
  const Writer tx_pdos = pdo_category(dictionary, PdoDirection::transmit, strings);
  const Writer rx_pdos = pdo_category(dictionary, PdoDirection::receive, strings);
  const Writer clock =
      description.distributed_clocks ? sii_distributed_clock_category(strings) : Writer();

  Writer image;
  image.bytes().resize(sii_word::kFirstCategory * 2);
  store_fixed_part(image.bytes(), description);
  image.put_category(SiiCategory::strings, strings.category());
  image.put_category(SiiCategory::general, general);
  if (description.exchanges_data()) {
    image.put_category(SiiCategory::fmmu, fmmu_category(description));
    image.put_category(SiiCategory::sync_manager, sync_manager_category(description, dictionary));
  }
  if (!tx_pdos.empty()) {
    image.put_category(SiiCategory::tx_pdo, tx_pdos);
  }
  if (!rx_pdos.empty()) {
    image.put_category(SiiCategory::rx_pdo, rx_pdos);
  }
  if (!clock.empty()) {
    image.put_category(SiiCategory::distributed_clock, clock);
  }
  image.put(static_cast<std::uint16_t>(SiiCategory::end));

  fill_eeprom(image.bytes(), description.name, description.sii_size_kbit, description.sii_grows);
  return std::move(image.bytes());
}

void fill_eeprom(std::vector<std::byte>& image, const std::string& name, std::uint16_t kbit,
                 bool grows) {
  constexpr std::size_t kBytesInKbit = 128;
  constexpr std::uint16_t kLargest = 0x4000;
  while (grows && kbit < kLargest && image.size() > kbit * kBytesInKbit) {
    kbit = static_cast<std::uint16_t>(2 * kbit);
  }
  const std::size_t capacity = kbit * kBytesInKbit;
  if (image.size() > capacity) {
    throw std::logic_error("SII image of " + name + " takes " + std::to_string(image.size()) +
                           " bytes, the EEPROM has " + std::to_string(capacity));
  }
  base::store_le(image, sii_word::kSize * 2, static_cast<std::uint16_t>(kbit - 1));
  image.resize(capacity, std::byte{0xFF});
}

}  // namespace stator::ethercat
