#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "stator/base/sim_time.hpp"
#include "stator/can/frame.hpp"
#include "stator/ethercat/segment/topology.hpp"
#include "stator/product/device/host_port.hpp"
#include "stator/rack/faults/fault_configuration.hpp"
#include "stator/rack/kept/storage_completion.hpp"
#include "stator/rack/world/device_address.hpp"
#include "stator/rack/world/rack_event.hpp"

namespace stator::rack {

/// What can be done to a rack from outside beside EtherCAT frames, which have a path of their own.
/// A rack tells its journal of each before it carries it out, so the same commands and frames make
/// the same rack to the last bit. `now` is the moment to which the rack has been brought; bytes
/// that a command refers to live as long as the call that takes it.
namespace command {

/// Time moves on.
struct Advance {
  base::SimTime now;
};
/// The firmware of a segment's devices takes what frames brought.
struct TakeBusEvents {
  std::size_t segment = 0;
  base::SimTime now;
};
/// An interface of a segment's master got or lost its carrier.
struct SetCarrier {
  std::size_t segment = 0;
  ethercat::MasterInterface interface = ethercat::MasterInterface::primary;
  bool up = false;
  base::SimTime now;
};
/// A frame that was held up comes out, if there is one, and the firmware takes what it brought.
struct ReleaseFrame {
  std::size_t segment = 0;
  base::SimTime now;
};
/// A program's frame comes through a port of a CAN bus.
struct PutCanFrame {
  std::size_t bus = 0;
  std::size_t port = 0;
  can::Frame frame;
};
/// All ports of all buses are replaced by new, empty ones.
struct ReplacePorts {};
/// Bytes of a program come over a serial line.
struct PutBytes {
  std::size_t line = 0;
  std::span<const std::byte> bytes;
  base::SimTime now;
};
/// A program makes an event happen that is not in the timetable.
struct ApplyEvent {
  RackEvent event;
  base::SimTime now;
};
/// A program injects a fault.
struct InjectFault {
  FaultConfiguration fault;
  base::SimTime now;
};
/// A program ends the fault of this number; nothing: all faults.
struct ClearFault {
  std::optional<std::uint64_t> id;
  base::SimTime now;
};
/// A program reads an entry of a device's dictionary; reading may change the state of its firmware.
struct ReadObject {
  DeviceAddress device;
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
};
struct WriteObject {
  DeviceAddress device;
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::span<const std::byte> value;
  base::SimTime now;
};
/// A device learns that its order to keep something has been carried out or has failed.
struct CompleteStorage {
  StorageCompletion completion;
  base::SimTime now;
};
/// The controller beside a chip selects one of its SPI slaves.
struct SelectHostSpi {
  DeviceAddress device;
  product::HostSpi spi = product::HostSpi::pdi;
};
/// The controller beside a chip clocks bytes through the SPI slave that it has selected.
struct TransferHostSpi {
  DeviceAddress device;
  product::HostSpi spi = product::HostSpi::pdi;
  std::span<const std::byte> mosi;
  std::span<std::byte> miso;               ///< gets what the slave answers, as long as `mosi`
  std::optional<base::SimDuration> pause;  ///< see product::HostPort::transfer()
};
/// The controller beside a chip ends the selection, `surplus_clocks` after the last byte.
struct DeselectHostSpi {
  DeviceAddress device;
  product::HostSpi spi = product::HostSpi::pdi;
  unsigned surplus_clocks = 0;
};
/// The controller beside a chip drives a pin.
struct SetHostPin {
  DeviceAddress device;
  product::HostPin pin = product::HostPin::latch0;
  bool level = false;
};
/// A frame of the network behind a device's EoE comes to its port.
struct PutEoeFrame {
  DeviceAddress device;
  std::span<const std::byte> frame;
};
/// A program gives the present moment a name.
struct Mark {
  std::string name;
};

}  // namespace command

/// Any of the commands above.
struct Command
    : std::variant<
          command::Advance, command::TakeBusEvents, command::SetCarrier, command::ReleaseFrame,
          command::PutCanFrame, command::ReplacePorts, command::PutBytes, command::ApplyEvent,
          command::InjectFault, command::ClearFault, command::ReadObject, command::WriteObject,
          command::CompleteStorage, command::SelectHostSpi, command::TransferHostSpi,
          command::DeselectHostSpi, command::SetHostPin, command::PutEoeFrame, command::Mark> {
  using variant::variant;
};

}  // namespace stator::rack
