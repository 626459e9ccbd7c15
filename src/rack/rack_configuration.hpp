#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/sim_time.hpp"
#include "devices/tmcm_3315/tmcm_3315.hpp"
#include "ethercat/segment.hpp"
#include "link/link_address.hpp"
#include "link/receive_wait.hpp"

namespace stator::rack {

enum class ClockKind : std::uint8_t {
  real,      ///< simulated time follows the machine's clock
  lockstep,  ///< simulated time moves only with the master's frames
};

/// Configuration of one product; a further product is a further alternative.
using ProductConfiguration = std::variant<devices::Tmcm3315Configuration>;

/// The cable in front of a device, on the master's side of it. See wiring.hpp for the defaults.
struct WiringConfiguration {
  std::optional<std::size_t>
      after{};                     ///< device of the segment it hangs at; default: the one before
  std::optional<unsigned> port{};  ///< port of that device; default: the one away from the master
  unsigned entry_port = 0;         ///< port of this device
  base::SimDuration cable_delay = ethercat::Segment::kDefaultCableDelay;
};

struct DeviceConfiguration {
  std::string name;  ///< unique within the rack; prefix of its signals
  ProductConfiguration product;
  WiringConfiguration wiring{};
  /// Of its slave controller, from port to port; default: the product's own.
  std::optional<base::SimDuration> forwarding_delay{};
  std::string eoe_interface{};  ///< TAP interface its EoE is bridged to; empty = no EoE
  std::string
      usb{};  ///< serial line its USB interface is, e.g. "pty:/tmp/module"; empty = no cable
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

struct RecordConfiguration {
  std::string file;
  base::SimDuration period{1'000'000};
  std::vector<std::string> signals{"*"};
};

/// A device by its place in the rack.
struct DeviceAddress {
  std::size_t segment = 0;
  std::size_t device = 0;
};

/// The cable at a port of a device breaks or heals.
struct CableEvent {
  DeviceAddress device;
  unsigned port = 0;
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
  std::string input;  ///< one of devices::EtherCatDevice::inputs()
  double value = 0.0;
  bool logged = true;  ///< false: one of the many small steps of a ramp
};

/// What can happen to a rack; a further kind is a further alternative.
using RackEvent = std::variant<CableEvent, PowerEvent, InputEvent>;

/// Something that happens at a fixed moment of simulated time.
struct EventConfiguration {
  base::SimDuration at;  ///< after the rack's power-on
  RackEvent event;
};

/// Everything one process runs.
struct RackConfiguration {
  ClockKind clock = ClockKind::real;
  base::SimDuration cycle{1'000'000};  ///< lockstep: simulated time per process-data exchange
  base::SimDuration step{50'000};      ///< lockstep: simulated time per other frame
  std::vector<SegmentConfiguration> segments;
  std::optional<RecordConfiguration> record;
  std::string state;  ///< directory in which devices keep EEPROM and firmware; empty = nothing kept
  std::vector<EventConfiguration> events;  ///< in any order
};

}  // namespace stator::rack
