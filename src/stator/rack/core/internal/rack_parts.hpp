#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/product/device/input.hpp"
#include "stator/rack/core/named_device.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/faults/faults.hpp"
#include "stator/rack/kept/device_storage.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/networks/eoe_port.hpp"
#include "stator/rack/networks/serial_lines.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/observe/journal.hpp"
#include "stator/rack/observe/output_files.hpp"
#include "stator/rack/observe/pin_trace.hpp"
#include "stator/rack/observe/recorder.hpp"
#include "stator/rack/observe/signal_tap.hpp"
#include "stator/rack/observe/traffic_tap.hpp"
#include "stator/rack/world/clock.hpp"
#include "stator/rack/world/coupling.hpp"
#include "stator/rack/world/overridable.hpp"
#include "stator/rack/world/rack_event.hpp"
#include "stator/rack/world/timetable.hpp"

namespace stator::rack {

class BusPort;

/// What a rack consists of, and what can happen to that. Rack brings it through
/// time and tells its journal.
struct RackParts {
  struct SegmentMembers {
    std::vector<NamedDevice> devices;
    std::vector<std::vector<product::Input>> inputs;       ///< by device
    std::vector<std::vector<product::InputRange>> ranges;  ///< of the inputs
    std::unique_ptr<ethercat::Segment> segment;
    std::uint16_t first_device = 0;  ///< number of its first device within the rack
  };

  struct BusMembers {
    std::unique_ptr<CanNetwork> network;
    std::vector<std::vector<product::Input>> inputs;       ///< by device
    std::vector<std::vector<product::InputRange>> ranges;  ///< of the inputs
    std::vector<BusPort*> ports;  ///< of programs, by number; null: it was closed
    std::uint16_t first_device = 0;
    std::uint16_t number = 0;  ///< under which the bus itself reports events
    bool wire = true;          ///< false: its devices are on serial lines only
  };

  using Arguments = std::array<base::EventArgument, 6>;

  /// Without networks; `events` gets the events of all and must outlive the parts.
  RackParts(const RackConfiguration& configuration, EventLog& events);

  /// Builds the devices of a network, whose names it adds to `names`.
  void add(const SegmentConfiguration& segment, std::vector<std::string>& names);
  void add(const BusConfiguration& bus, std::vector<std::string>& names);
  void connect_lines(const RackConfiguration& configuration);
  void begin_trace(const TraceConfiguration& configuration, ClockKind clock);

  /// Lets an event of the timetable or of a program happen, unless a fault holds what it sets.
  void apply_event(const RackEvent& event, base::SimTime now);
  /// Throws std::runtime_error for an input that does not exist or a value it cannot have.
  [[nodiscard]] const product::Input& find_input(const InputEvent& event) const;
  [[nodiscard]] Overridable<double>& held(const InputEvent& event);
  [[nodiscard]] Overridable<bool>& held(const CableEvent& event);
  [[nodiscard]] Overridable<bool>& held(const PowerEvent& event);
  /// Makes an input, a cable or a supply have the value of the event from now on.
  void enforce(const InputEvent& event, base::SimTime now);
  void enforce(const CableEvent& event, base::SimTime now);
  void enforce(const PowerEvent& event, base::SimTime now);
  void apply_input(const InputEvent& event, base::SimTime now);
  void apply_error_state(const ErrorStateEvent& event, base::SimTime now);
  void apply_frame_fault(const FrameFaultEvent& event, base::SimTime now);
  void apply_segment_fault(const SegmentFaultEvent& event, base::SimTime now);

  [[nodiscard]] product::Device& device(DeviceAddress address);
  /// `address` is on a segment.
  [[nodiscard]] product::EtherCatDevice& slave(DeviceAddress address) {
    return *segments[address.network].devices[address.device].device;
  }
  [[nodiscard]] std::span<const product::Input> inputs(DeviceAddress address) const {
    return (address.kind == NetworkKind::bus ? buses[address.network].inputs
                                             : segments[address.network].inputs)[address.device];
  }
  /// The number by which events name a device.
  [[nodiscard]] std::uint16_t number_of(DeviceAddress device) const;
  void report(std::uint16_t number, base::SimTime now, const base::EventRule& rule,
              const Arguments& arguments = {});
  void advance_devices(base::SimTime now);
  /// Passes a frame through a segment while somebody watches.
  std::optional<ethercat::MasterInterface> process_watched(std::size_t segment,
                                                           std::span<std::byte> frame,
                                                           base::SimTime arrival,
                                                           ethercat::MasterInterface entry);
  [[nodiscard]] base::SimTime next_coupling() const;
  /// Lets the couplings act that are due at `instant`.
  void act_couplings(base::SimTime instant);
  [[nodiscard]] base::SimTime next_tap() const;
  void sample_taps(base::SimTime now);

  EventLog& log;
  OutputFiles outputs;
  std::unique_ptr<PinTrace> trace;  ///< outlives the chip it looks at
  /// Ports of the devices whose EoE is bridged; destroyed after the devices.
  std::map<DeviceAddress, std::unique_ptr<EoePort>> eoe_ports;
  std::vector<SegmentMembers> segments;
  std::vector<BusMembers> buses;
  SerialLines lines;  ///< destroyed before devices and buses, to which they refer
  Timetable timetable;
  std::map<std::pair<DeviceAddress, std::string>, Overridable<double>>
      held_inputs;  ///< those ever set
  std::map<std::pair<DeviceAddress, unsigned>, Overridable<bool>>
      held_cables;                                         ///< by port; true: intact
  std::map<DeviceAddress, Overridable<bool>> held_powers;  ///< true: on
  std::vector<std::unique_ptr<Coupling>> couplings;
  std::optional<Recorder> recorder;
  std::vector<SignalTap*> taps;
  TrafficTap* traffic = nullptr;
  std::unique_ptr<DeviceStorage> storage;
  std::uint64_t orders_settled = 0;  ///< DeviceStorage::orders() when settle() last ended
  base::SimTime advanced_to;
  Journal* journal = nullptr;
  bool inside = false;  ///< within a call that the journal has recorded, see NestedCalls
  std::unique_ptr<faults::Target> ground;  ///< what faults reach
  std::unique_ptr<Faults> faults;          ///< destroyed first: they refer to everything above
};

}  // namespace stator::rack
