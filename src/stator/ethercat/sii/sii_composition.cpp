// An SII image from its contents, for devices without a dictionary.

#include "stator/ethercat/sii/sii_writer.hpp"
#include "stator/ethercat/units/sii_interface.hpp"

namespace stator::ethercat {

SiiWriter sii_distributed_clock_category(SiiStringTable& strings) {
  const auto put_mode = [](SiiWriter& body, std::uint16_t activate, std::uint8_t name) {
    body.put(std::uint32_t{0});  // cycle time 0: the master's
    body.put(std::uint32_t{0});  // shift time 0
    body.put(std::uint32_t{0});  // shift time 1
    body.put(std::int16_t{0});   // SYNC1 cycle factor
    body.put(activate);
    body.put(std::int16_t{1});  // SYNC0 cycle factor
    body.put(name);
    body.put(std::uint8_t{0});
    body.put(std::uint32_t{0});
  };
  SiiWriter body;
  put_mode(body, 0x0000, strings.number("Synchron"));
  put_mode(body, 0x0300, strings.number("DcSync"));
  return body;
}

namespace {

void store_words(std::span<std::byte> image, const SiiContents& contents) {
  using namespace sii_word;
  const auto put = [image](std::size_t word, auto value) {
    base::store_le(image, word * 2, value);
  };
  put(kPdiControl, contents.pdi_control);
  put(kPdiConfiguration, contents.pdi_configuration);
  put(kSyncPulseLength, contents.sync_pulse_length);
  put(kStationAlias, contents.station_alias);
  put(kChecksum, std::uint16_t{sii_checksum(image)});
  put(kVendorId, contents.vendor_id);
  put(kProductCode, contents.product_code);
  put(kRevision, contents.revision);
  put(kSerialNumber, contents.serial_number);
  const auto put_area = [&](std::size_t word, const MailboxArea& area) {
    put(word, area.offset);
    put(word + 1, area.length);
  };
  put_area(kBootstrapMailbox, contents.bootstrap_receive_mailbox);
  put_area(kBootstrapMailbox + 2, contents.bootstrap_transmit_mailbox);
  put_area(kStandardMailbox, contents.receive_mailbox);
  put_area(kStandardMailbox + 2, contents.transmit_mailbox);
  put(kMailboxProtocols, contents.mailbox_protocols);
  put(kVersion, std::uint16_t{1});
}

SiiWriter general_category(const SiiContents& contents, SiiStringTable& strings) {
  constexpr std::uint16_t kTwoMiiPorts = 0x0011;
  SiiWriter body;
  const std::uint8_t group = strings.number(contents.group);
  body.put(group);
  body.put(std::uint8_t{0});
  body.put(strings.number(contents.order_code));
  body.put(strings.number(contents.name));
  body.put(std::uint8_t{0});
  body.put(contents.coe_details);
  body.bytes().resize(14);
  body.put(group);
  body.put(std::uint8_t{0});
  body.put(kTwoMiiPorts);
  body.bytes().resize(32);
  return body;
}

SiiWriter sync_manager_category(const SiiContents& contents) {
  SiiWriter body;
  for (const SiiSyncManager& manager : contents.sync_managers) {
    body.put(manager.start);
    body.put(manager.length);
    body.put(manager.control);
    body.put(std::uint8_t{0});
    body.put(manager.enable);
    body.put(manager.type);
  }
  return body;
}

SiiWriter pdo_category(std::span<const SiiPdo> pdos, SiiStringTable& strings) {
  SiiWriter body;
  for (const SiiPdo& pdo : pdos) {
    body.put(pdo.index);
    body.put(static_cast<std::uint8_t>(pdo.entries.size()));
    body.put(pdo.sync_manager);
    body.put(std::uint8_t{0});
    body.put(strings.number(pdo.name));
    body.put(std::uint16_t{0});
    for (const SiiPdo::Entry& entry : pdo.entries) {
      body.put(entry.index);
      body.put(entry.subindex);
      body.put(strings.number(entry.name));
      body.put(entry.data_type);
      body.put(entry.bits);
      body.put(std::uint16_t{0});
    }
  }
  return body;
}

}  // namespace

std::vector<std::byte> compose_sii_image(const SiiContents& contents) {
  SiiStringTable strings;
  strings.number(contents.name);  // masters print string 1
  const SiiWriter general = general_category(contents, strings);
  const SiiWriter tx_pdos = pdo_category(contents.tx_pdos, strings);
  const SiiWriter rx_pdos = pdo_category(contents.rx_pdos, strings);
  const SiiWriter clock =
      contents.distributed_clocks ? sii_distributed_clock_category(strings) : SiiWriter();
  SiiWriter image;
  image.bytes().resize(sii_word::kFirstCategory * 2);
  store_words(image.bytes(), contents);
  if (!contents.parameter_ram.empty()) {
    SiiWriter parameters;
    parameters.bytes() = contents.parameter_ram;
    image.put_category(SiiCategory::parameter_ram, parameters);  // loaded only if it is the first
  }
  image.put_category(SiiCategory::strings, strings.category());
  image.put_category(SiiCategory::general, general);
  SiiWriter fmmus;
  for (const std::uint8_t usage : contents.fmmu_usage) {
    fmmus.put(usage);
  }
  image.put_category(SiiCategory::fmmu, fmmus);
  image.put_category(SiiCategory::sync_manager, sync_manager_category(contents));
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
  fill_eeprom(image.bytes(), contents.name, contents.size_kbit, contents.grows);
  return std::move(image.bytes());
}

}  // namespace stator::ethercat
