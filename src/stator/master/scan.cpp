#include "stator/master/scan.hpp"

#include <array>
#include <string>
#include <utility>

#include "stator/master/registers.hpp"
#include "stator/master/sii_reader.hpp"
#include "stator/master/text.hpp"

namespace stator::master {

namespace {

constexpr std::uint16_t kFirstStation = 0x1001;
constexpr std::uint16_t kInitWithAcknowledge = 0x11;

/// Ports as DL status shows them: link in bits 4 to 7, then loop and communication in turns.
std::array<PortStatus, 4> parse_dl_status(std::uint16_t status) {
  std::array<PortStatus, 4> ports{};
  for (unsigned port = 0; port < ports.size(); ++port) {
    ports[port] = {.link = (status >> (4 + port) & 1U) != 0,
                   .loop_closed = (status >> (8 + 2 * port) & 1U) != 0,
                   .communication = (status >> (9 + 2 * port) & 1U) != 0};
  }
  return ports;
}

Result<std::size_t> count_slaves(Bus& bus) {
  std::array<std::byte, 2> type{};
  const auto counter = bus.execute(ethercat::Command::brd,
                                   ethercat::physical_address(0, registers::kInformation), type);
  if (!counter) {
    if (counter.error().code != ErrorCode::timeout) {
      return base::Unexpected{counter.error()};
    }
    return fail(ErrorCode::no_slaves, "no EtherCAT slave answers: " + counter.error().text);
  }
  if (*counter == 0) {
    return fail(ErrorCode::no_slaves,
                "frames come back, but no EtherCAT slave has processed them; is the cable in the "
                "slave's IN port, and does the line not loop back to this machine?");
  }
  return std::size_t{*counter};
}

/// Brings all slaves to a defined start: Init, loops automatic, nothing mapped, counters cleared.
Result<void> reset_slaves(Bus& bus) {
  struct Write {
    std::uint16_t address;
    std::size_t length;  ///< zero bytes
  };
  constexpr std::array kWrites{
      Write{registers::kDlControlLoops, 1},
      Write{registers::kEcatEventMask, 2},
      Write{registers::kReceiveErrors, 8},
      Write{registers::kFmmu, std::size_t{16} * registers::kFmmuSize},
      Write{registers::kSyncManager, std::size_t{16} * registers::kSyncManagerSize},
      Write{registers::kSyncActivation, 1}};
  std::array<std::byte, 2> control{};
  base::store_le(control.data(), kInitWithAcknowledge);
  if (auto done = bus.broadcast(registers::kAlControl, control); !done) {
    return done;
  }
  for (const Write& write : kWrites) {
    if (auto done = bus.broadcast(write.address, std::vector<std::byte>(write.length)); !done) {
      return done;
    }
  }
  return {};
}

/// Gives the slave at `position` its address and reads who it is.
Result<Slave> identify(Bus& bus, std::uint16_t position) {
  Slave slave;
  slave.position = position;
  slave.station_address = static_cast<std::uint16_t>(kFirstStation + position);
  const Station station = station_of(slave);

  std::array<std::byte, 2> address{};
  base::store_le(address.data(), slave.station_address);
  const auto counter =
      bus.execute(ethercat::Command::apwr,
                  ethercat::physical_address(ethercat::auto_increment_address(position),
                                             registers::kStationAddress),
                  address);
  if (!counter) {
    return base::Unexpected{counter.error()};
  }
  std::array<std::byte, 12> chip{};
  if (const auto done = bus.read(station, registers::kInformation, chip); !done) {
    return base::Unexpected{done.error()};
  }
  slave.fmmu_count = std::to_integer<std::uint8_t>(chip[4]);
  slave.sync_manager_count = std::to_integer<std::uint8_t>(chip[5]);
  slave.distributed_clocks = (std::to_integer<unsigned>(chip[8]) & 0x04U) != 0;

  const auto dl_status = bus.read_number<std::uint16_t>(station, registers::kDlStatus);
  if (!dl_status) {
    return base::Unexpected{dl_status.error()};
  }
  slave.ports = parse_dl_status(*dl_status);

  const auto contents = read_sii(bus, station);
  if (!contents) {
    return base::Unexpected{contents.error()};
  }
  auto information = parse_sii(*contents);
  if (!information) {
    Error error = information.error();
    error.text = station.name() + ": " + error.text;
    return base::Unexpected{error};
  }
  slave.information = std::move(*information);
  return slave;
}

}  // namespace

Result<std::vector<Slave>> scan_segment(Bus& bus) {
  const auto count = count_slaves(bus);
  if (!count) {
    return base::Unexpected{count.error()};
  }
  if (const auto done = reset_slaves(bus); !done) {
    return base::Unexpected{done.error()};
  }
  std::vector<Slave> slaves;
  slaves.reserve(*count);
  for (std::size_t position = 0; position < *count; ++position) {
    auto slave = identify(bus, static_cast<std::uint16_t>(position));
    if (!slave) {
      return base::Unexpected{slave.error()};
    }
    slaves.push_back(std::move(*slave));
  }
  return slaves;
}

}  // namespace stator::master
