#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/event.hpp"
#include "base/sim_time.hpp"
#include "can/error_counters.hpp"
#include "can/frame_faults.hpp"
#include "devices/can_device.hpp"
#include "devices/junction/junction.hpp"
#include "devices/tmc8461/tmc8461.hpp"
#include "devices/tmc8670/tmc8670.hpp"
#include "devices/tmcc160/tmcc160.hpp"
#include "devices/tmcm_142/tmcm_142.hpp"
#include "devices/tmcm_3315/tmcm_3315.hpp"
#include "ethercat/segment.hpp"
#include "link/link_address.hpp"
#include "link/receive_wait.hpp"
#include "rack/device_address.hpp"
#include "rack/fault_configuration.hpp"

namespace stator::rack {

enum class ClockKind : std::uint8_t {
  real,      ///< simulated time follows the machine's clock
  lockstep,  ///< simulated time moves only with the master's frames
};

/// A CAN device that is none of the products: a class of one's own, in a program that uses Stator
/// as a library.
struct OwnCanDevice {
  std::function<std::unique_ptr<devices::CanDevice>(const base::EventReporter&)> make;
};

/// Configuration of one product; a further product is a further alternative.
using ProductConfiguration =
    std::variant<devices::Tmcm3315Configuration, devices::Tmcc160Configuration,
                 devices::Tmcm142Configuration, devices::Tmc8670Configuration,
                 devices::Tmc8461Configuration, devices::JunctionConfiguration, OwnCanDevice>;

/// The cable in front of a device, on the master's side of it. See wiring.hpp for the defaults.
struct WiringConfiguration {
  std::optional<std::size_t>
      after{};                     ///< device of the segment it hangs at; default: the one before
  std::optional<unsigned> port{};  ///< port of that device; default: the one away from the master
  unsigned entry_port = 0;         ///< port of this device
  base::SimDuration cable_delay = ethercat::Segment::kDefaultCableDelay;
};

/// A serial interface of a device and the line it is connected to.
struct SerialConnection {
  std::string interface;  ///< one of devices::Device::serial_interfaces()
  std::string line;       ///< e.g. "pty:/tmp/module"; see link::kSerialLinkForms

  friend bool operator==(const SerialConnection&, const SerialConnection&) = default;
};

/// How bytes pass over a serial line, and how its thread waits for them.
struct SerialLineConfiguration {
  std::string link;     ///< as in SerialConnection::line
  bool pacing = false;  ///< bytes take the time of their bits, in simulated time
  link::WaitMode wait = link::WaitMode::block;
  base::SimDuration spin_time{200'000};  ///< of WaitMode::adaptive
  std::optional<unsigned> cpu{};         ///< processor the line's thread is tied to
};

struct DeviceConfiguration {
  std::string name;  ///< unique within the rack; prefix of its signals
  ProductConfiguration product;
  WiringConfiguration wiring{};
  /// Of its slave controller, from port to port; default: the product's own.
  std::optional<base::SimDuration> forwarding_delay{};
  std::string eoe_interface{};  ///< TAP interface its EoE is bridged to; empty = no EoE
  std::string host_link{};      ///< socket for the firmware beside a chip; see link::kChipLinkForms
  std::vector<SerialConnection> serial{};  ///< its serial interfaces that have a cable
};

/// EtherCAT slaves wired together behind one link, or two with cable redundancy.
struct SegmentConfiguration {
  /// Where the master is; LinkKind::in_process = reached only from inside the process.
  link::LinkAddress link;
  /// The master's second interface, at the end of the last device; in_process = no cable
  /// redundancy.
  link::LinkAddress redundant_link;
  link::WaitMode wait = link::WaitMode::block;
  base::SimDuration spin_time{200'000};  ///< of WaitMode::adaptive
  std::optional<unsigned> cpu;           ///< processor the segment's thread is tied to
  std::string capture;  ///< pcap file of everything that crosses the link; empty = none
  std::vector<DeviceConfiguration> devices;

  [[nodiscard]] bool redundant() const { return !redundant_link.in_process(); }
};

/// CAN devices on one wire, and the ports through which masters reach it.
struct BusConfiguration {
  std::string name = "can0";  ///< unique within the rack; empty if there is no wire
  /// False: no wire. Its devices are reached over serial lines only, and nobody sees a bus.
  bool wire = true;
  /// Bit/s, kept to in simulated time; nothing: unlimited, frames take no time.
  std::optional<std::uint32_t> bit_rate{1'000'000};
  bool ports_acknowledge = true;   ///< see can::BusSettings
  std::vector<std::string> ports;  ///< e.g. "slcan:/tmp/stator-can0"; see link::kCanLinkForms
  std::string log;                 ///< candump log of everything on the wire; empty = none
  std::string capture;             ///< the same as pcap file
  std::optional<unsigned> cpu;     ///< processor the bus's thread is tied to
  std::vector<DeviceConfiguration> devices;
};

/// A bus for devices that are reached over serial lines only.
[[nodiscard]] inline BusConfiguration bus_without_wire() {
  BusConfiguration bus;
  bus.name.clear();
  bus.wire = false;
  bus.bit_rate = std::nullopt;
  return bus;
}

struct RecordConfiguration {
  std::string file;
  base::SimDuration period{1'000'000};
  std::vector<std::string> signals{"*"};
};

/// A logic analyser at the pins of a TMC8461.
struct TraceConfiguration {
  std::string file;                 ///< value change dump to write
  std::string device;               ///< empty: the first one of the rack
  std::vector<std::string> pins{};  ///< "MFCIO00".."MFC_HV7"; empty: those wired to something
  std::size_t queue = std::size_t{1} << 18U;  ///< edges that wait for the disk at most, from 64 on
};

/// The cable at a port of an EtherCAT device breaks or heals; on a CAN bus the one with which the
/// device is connected to it.
struct CableEvent {
  DeviceAddress device;
  unsigned port = 0;  ///< of an EtherCAT device
  bool intact = false;
};

/// The supply of a device is switched.
struct PowerEvent {
  DeviceAddress device;
  bool on = false;
};

/// Something around a device is set: a switch is pressed, a torque acts, a supply sags.
struct InputEvent {
  DeviceAddress device;
  std::string input;  ///< one of devices::Device::inputs()
  double value = 0.0;
  bool logged = true;  ///< false: one of the many small steps of a ramp
};

/// The CAN controller of a device gets into another error state.
struct ErrorStateEvent {
  DeviceAddress device;
  can::ErrorState state = can::ErrorState::error_passive;  ///< or bus_off
};

/// Something is done to the next frames of a CAN bus.
struct FrameFaultEvent {
  std::size_t bus = 0;
  std::optional<std::size_t> device{};  ///< only to frames this device of the bus sends
  can::FrameFault fault{};              ///< its sender is filled in when it happens
};

/// Something is done to the next frames of a segment that pass a port of a device.
struct SegmentFaultEvent {
  std::size_t segment = 0;
  ethercat::FrameFault fault{};
};

/// What can happen to a rack; a further kind is a further alternative.
using RackEvent = std::variant<CableEvent, PowerEvent, InputEvent, ErrorStateEvent, FrameFaultEvent,
                               SegmentFaultEvent>;

/// Something that happens at a fixed moment of simulated time.
struct EventConfiguration {
  base::SimDuration at;  ///< after the rack's power-on
  RackEvent event;
};

/// A signal of one device that sets an input of another, see wires.hpp.
struct WireConfiguration {
  DeviceAddress from;
  std::string signal;  ///< one of devices::Device::signals()
  DeviceAddress to;
  std::string input;  ///< one of devices::Device::inputs()
  /// A digital wire carries `high` while the signal is at or above the threshold, else `low`;
  /// without a threshold the wire is analog.
  std::optional<double> threshold{0.5};
  double low = 0.0;
  double high = 1.0;
  double scale = 1.0;          ///< of an analog wire, units of the input per unit of the signal
  double offset = 0.0;         ///< of an analog wire, units of the input
  base::SimDuration delay{0};  ///< a multiple of kWirePeriod
};

/// Distance of the instants at which wires act, beginning at power-on.
inline constexpr base::SimDuration kWirePeriod{50'000};

/// Everything one process runs.
struct RackConfiguration {
  ClockKind clock = ClockKind::real;
  /// Lockstep: simulated time per process-data exchange, on a CAN bus per SYNC.
  base::SimDuration cycle{1'000'000};
  base::SimDuration step{50'000};  ///< lockstep: simulated time per other frame
  std::vector<SegmentConfiguration> segments;
  std::vector<BusConfiguration> buses;
  /// Of serial lines that devices name; one that is not here is as SerialLineConfiguration says.
  std::vector<SerialLineConfiguration> lines;
  std::optional<RecordConfiguration> record;
  std::optional<TraceConfiguration> trace;
  std::string state;  ///< directory in which devices keep what outlives power; empty = nothing kept
  std::vector<EventConfiguration> events;  ///< in any order
  std::vector<FaultConfiguration> faults;
  std::vector<WireConfiguration> wires;  ///< one at most for each input
};

}  // namespace stator::rack
