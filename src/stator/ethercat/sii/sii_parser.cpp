// Reads an SII image (ETG.2010): its fixed part and the categories that a slave or a master needs.
#include <algorithm>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/ethercat/units/sii_interface.hpp"

namespace stator::ethercat {

namespace {

using Bytes = std::span<const std::byte>;

std::uint8_t byte_at(Bytes bytes, std::size_t offset) {
  return std::to_integer<std::uint8_t>(bytes[offset]);
}

std::string text_of(const SiiContents& contents, std::uint8_t number) {
  return number == 0 || number > contents.strings.size() ? std::string()
                                                         : contents.strings[number - 1U];
}

MailboxArea mailbox_at(Bytes image, std::size_t word) {
  return {base::load_le<std::uint16_t>(image, word * 2),
          base::load_le<std::uint16_t>(image, word * 2 + 2)};
}

bool parse_strings(Bytes body, SiiContents& contents) {
  if (body.empty()) {
    return false;
  }
  std::size_t at = 1;
  for (unsigned left = byte_at(body, 0); left > 0; --left) {
    if (at >= body.size() || at + 1 + byte_at(body, at) > body.size()) {
      return false;
    }
    const std::size_t length = byte_at(body, at);
    std::string text;
    for (const std::byte character : body.subspan(at + 1, length)) {
      text += static_cast<char>(character);
    }
    contents.strings.push_back(std::move(text));
    at += 1 + length;
  }
  return true;
}

bool parse_general(Bytes body, SiiContents& contents) {
  if (body.size() < 32) {
    return false;
  }
  contents.group = text_of(contents, byte_at(body, 0));
  contents.order_code = text_of(contents, byte_at(body, 2));
  contents.name = text_of(contents, byte_at(body, 3));
  contents.coe_details = byte_at(body, 5);
  return true;
}

void parse_sync_managers(Bytes body, SiiContents& contents) {
  for (; body.size() >= 8; body = body.subspan(8)) {
    contents.sync_managers.push_back({.start = base::load_le<std::uint16_t>(body, 0),
                                      .length = base::load_le<std::uint16_t>(body, 2),
                                      .control = byte_at(body, 4),
                                      .enable = byte_at(body, 6),
                                      .type = byte_at(body, 7)});
  }
}

bool parse_pdos(Bytes body, const SiiContents& contents, std::vector<SiiPdo>& pdos) {
  while (body.size() >= 8) {
    SiiPdo pdo;
    pdo.index = base::load_le<std::uint16_t>(body, 0);
    const std::size_t count = byte_at(body, 2);
    pdo.sync_manager = byte_at(body, 3);
    pdo.name = text_of(contents, byte_at(body, 5));
    body = body.subspan(8);
    if (count * 8 > body.size()) {
      return false;
    }
    for (std::size_t i = 0; i < count; ++i, body = body.subspan(8)) {
      pdo.entries.push_back({.index = base::load_le<std::uint16_t>(body, 0),
                             .subindex = byte_at(body, 2),
                             .data_type = byte_at(body, 4),
                             .bits = byte_at(body, 5),
                             .name = text_of(contents, byte_at(body, 3))});
    }
    pdos.push_back(std::move(pdo));
  }
  return true;
}

bool parse_category(SiiCategory type, Bytes body, SiiContents& contents) {
  switch (type) {
    case SiiCategory::parameter_ram:
      contents.parameter_ram.assign(body.begin(), body.end());
      return true;
    case SiiCategory::distributed_clock:
      contents.distributed_clocks = true;
      return true;
    case SiiCategory::strings:
      return parse_strings(body, contents);
    case SiiCategory::general:
      return parse_general(body, contents);
    case SiiCategory::fmmu:
      for (const std::byte usage : body) {
        contents.fmmu_usage.push_back(std::to_integer<std::uint8_t>(usage));
      }
      return true;
    case SiiCategory::sync_manager:
      parse_sync_managers(body, contents);
      return true;
    case SiiCategory::tx_pdo:
      return parse_pdos(body, contents, contents.tx_pdos);
    case SiiCategory::rx_pdo:
      return parse_pdos(body, contents, contents.rx_pdos);
    default:
      return true;
  }
}

}  // namespace

std::optional<SiiContents> parse_sii_image(Bytes image) {
  using namespace sii_word;
  if (image.size() < kFirstCategory * 2 || sii_checksum(image) != byte_at(image, kChecksum * 2)) {
    return std::nullopt;
  }
  SiiContents contents;
  contents.pdi_control = base::load_le<std::uint16_t>(image, kPdiControl * 2);
  contents.pdi_configuration = base::load_le<std::uint16_t>(image, kPdiConfiguration * 2);
  contents.sync_pulse_length = base::load_le<std::uint16_t>(image, kSyncPulseLength * 2);
  contents.size_kbit =
      static_cast<std::uint16_t>(base::load_le<std::uint16_t>(image, kSize * 2) + 1);
  contents.station_alias = base::load_le<std::uint16_t>(image, kStationAlias * 2);
  contents.vendor_id = base::load_le<std::uint32_t>(image, kVendorId * 2);
  contents.product_code = base::load_le<std::uint32_t>(image, kProductCode * 2);
  contents.revision = base::load_le<std::uint32_t>(image, kRevision * 2);
  contents.serial_number = base::load_le<std::uint32_t>(image, kSerialNumber * 2);
  contents.bootstrap_receive_mailbox = mailbox_at(image, kBootstrapMailbox);
  contents.bootstrap_transmit_mailbox = mailbox_at(image, kBootstrapMailbox + 2);
  contents.receive_mailbox = mailbox_at(image, kStandardMailbox);
  contents.transmit_mailbox = mailbox_at(image, kStandardMailbox + 2);
  contents.mailbox_protocols = base::load_le<std::uint16_t>(image, kMailboxProtocols * 2);

  Bytes rest = image.subspan(kFirstCategory * 2);
  while (rest.size() >= 4) {
    const auto type = static_cast<SiiCategory>(base::load_le<std::uint16_t>(rest, 0));
    if (type == SiiCategory::end) {
      return contents;
    }
    const std::size_t length = base::load_le<std::uint16_t>(rest, 2) * std::size_t{2};
    rest = rest.subspan(4);
    if (length > rest.size() || !parse_category(type, rest.first(length), contents)) {
      return std::nullopt;
    }
    rest = rest.subspan(length);
  }
  return contents;
}

}  // namespace stator::ethercat
