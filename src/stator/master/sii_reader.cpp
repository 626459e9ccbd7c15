#include "stator/master/sii_reader.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/master/registers.hpp"
#include "stator/master/text.hpp"

namespace stator::master {

namespace {

constexpr std::uint16_t kEndOfCategories = 0xFFFF;

// Mailbox protocols (SII word 1Ch) and CoE details (general category), ETG.2010 tables 2 and 7.
constexpr unsigned kEoe = 0x02;
constexpr unsigned kCoe = 0x04;
constexpr unsigned kFoe = 0x08;
constexpr unsigned kSdoInformation = 0x02;
constexpr unsigned kCompleteAccess = 0x20;

// Register 0502h.
constexpr std::uint16_t kReadCommand = 0x0100;
constexpr std::uint16_t kEightByteReads = 0x0040;
constexpr std::uint16_t kErrorBits = 0x7800;
constexpr std::uint16_t kBusy = 0x8000;

constexpr base::SimDuration kSiiPollInterval(100'000);

std::uint16_t word(std::span<const std::byte> contents, std::size_t address) {
  return base::load_le<std::uint16_t>(contents, 2 * address);
}

/// Writes a read command. It is refused while the EEPROM is busy, e.g. with this very command when
/// its answer got lost.
Result<void> write_read_command(Bus& bus, const Station& station, std::uint32_t address) {
  std::array<std::byte, 6> command{};
  base::store_le<std::uint16_t>(command.data(), kReadCommand);
  base::store_le<std::uint32_t>(command.data() + 2, address);
  const base::SimTime deadline = bus.port().now() + bus.options().sii_timeout;
  while (true) {
    auto written = bus.write(station, registers::kSiiControl, command);
    if (written || written.error().code != ErrorCode::working_counter ||
        bus.port().now() >= deadline) {
      return written;
    }
    bus.port().wait(kSiiPollInterval);
  }
}

/// Waits for the end of a command; the status then.
Result<std::uint16_t> wait_for_eeprom(Bus& bus, const Station& station) {
  const base::SimTime deadline = bus.port().now() + bus.options().sii_timeout;
  while (true) {
    auto status = bus.read_number<std::uint16_t>(station, registers::kSiiControl);
    if (!status || (*status & kBusy) == 0) {
      return status;
    }
    if (bus.port().now() >= deadline) {
      return fail(ErrorCode::sii, "the EEPROM of " + station.name() + " stays busy");
    }
    bus.port().wait(kSiiPollInterval);
  }
}

/// Appends the four or eight bytes from word `contents.size() / 2` on.
Result<void> read_more(Bus& bus, const Station& station, std::vector<std::byte>& contents) {
  const auto address = static_cast<std::uint32_t>(contents.size() / 2);
  if (auto written = write_read_command(bus, station, address); !written) {
    return written;
  }
  const auto status = wait_for_eeprom(bus, station);
  if (!status) {
    return base::Unexpected{status.error()};
  }
  if ((*status & kErrorBits) != 0) {
    return fail(ErrorCode::sii,
                "the EEPROM of " + station.name() + " refused to read word " +
                    hexadecimal(address, 4) + ", status " + hexadecimal(*status, 4) +
                    "; is an EEPROM fitted and loaded?",
                *status);
  }
  std::array<std::byte, 8> data{};
  const auto bytes = std::span(data).first((*status & kEightByteReads) != 0 ? 8 : 4);
  if (auto done = bus.read(station, registers::kSiiData, bytes); !done) {
    return done;
  }
  contents.insert(contents.end(), bytes.begin(), bytes.end());
  return {};
}

Result<void> read_until(Bus& bus, const Station& station, std::vector<std::byte>& contents,
                        std::size_t length) {
  while (contents.size() < length) {
    if (auto done = read_more(bus, station, contents); !done) {
      return done;
    }
  }
  return {};
}

}  // namespace

Result<std::vector<std::byte>> read_sii(Bus& bus, const Station& station) {
  // Bit 1 takes the EEPROM from a host that holds it; then it is offered to the bus.
  for (const std::uint8_t owner : {std::uint8_t{2}, std::uint8_t{0}}) {
    if (const auto done = bus.write_number(station, registers::kSiiOwner, owner); !done) {
      return base::Unexpected{done.error()};
    }
  }
  std::vector<std::byte> contents;
  if (const auto done = read_until(bus, station, contents, 2 * ethercat::sii_word::kFirstCategory);
      !done) {
    return base::Unexpected{done.error()};
  }
  const std::size_t size = (std::size_t{word(contents, ethercat::sii_word::kSize)} + 1) * 128;
  std::size_t at = 2 * ethercat::sii_word::kFirstCategory;
  while (at + 4 <= size) {
    if (const auto done = read_until(bus, station, contents, at + 4); !done) {
      return base::Unexpected{done.error()};
    }
    if (base::load_le<std::uint16_t>(contents, at) == kEndOfCategories) {
      break;
    }
    at += 4 + std::size_t{base::load_le<std::uint16_t>(contents, at + 2)} * 2;
    if (const auto done = read_until(bus, station, contents, std::min(at, size)); !done) {
      return base::Unexpected{done.error()};
    }
  }
  return contents;
}

Result<SlaveInformation> parse_sii(std::span<const std::byte> contents) {
  const auto parsed = ethercat::parse_sii_image(contents);
  if (!parsed) {
    return fail(ErrorCode::sii,
                "the SII is damaged: too short, its checksum does not fit, or a category runs past "
                "its end; write a valid image to the EEPROM");
  }
  SlaveInformation information{.identity = {.vendor_id = parsed->vendor_id,
                                            .product_code = parsed->product_code,
                                            .revision = parsed->revision,
                                            .serial_number = parsed->serial_number},
                               .alias = parsed->station_alias,
                               .name = parsed->name,
                               .order_code = parsed->order_code,
                               .group = parsed->group,
                               .receive_mailbox = parsed->receive_mailbox,
                               .transmit_mailbox = parsed->transmit_mailbox,
                               .coe = (parsed->mailbox_protocols & kCoe) != 0,
                               .foe = (parsed->mailbox_protocols & kFoe) != 0,
                               .eoe = (parsed->mailbox_protocols & kEoe) != 0,
                               .sdo_information = (parsed->coe_details & kSdoInformation) != 0,
                               .complete_access = (parsed->coe_details & kCompleteAccess) != 0,
                               .sync_managers = parsed->sync_managers};
  return information;
}

}  // namespace stator::master
