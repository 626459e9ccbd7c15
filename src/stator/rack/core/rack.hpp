#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/expected.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/can/port.hpp"
#include "stator/dictionary/declaration.hpp"
#include "stator/dictionary/refusal.hpp"
#include "stator/ethercat/segment/released_frame.hpp"
#include "stator/ethercat/segment/topology.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/rack/world/device_address.hpp"
#include "stator/rack/world/rack_event.hpp"

namespace stator::dictionary {
class Entry;
}
namespace stator::ethercat {
class Segment;
}
namespace stator::product {
class Device;
}

namespace stator::rack {

class CanNetwork;
class DeviceStorage;
class EventLog;
class Faults;
class Journal;
class LockstepClock;
class OutputFiles;
class PinTrace;
class Recorder;
class SerialLine;
class SignalTap;
class TrafficTap;
struct FaultConfiguration;
struct NamedDevice;
struct RackConfiguration;
struct StorageCompletion;

/// All devices of one process and their recording. Passive: whoever owns a link or a master brings
/// frames and time. Not thread-safe.
class Rack {
 public:
  /// Builds every device. `log` gets their events and must outlive the rack. Throws
  /// std::runtime_error when the recording cannot be opened or names signals that do not exist,
  /// when an event sets an input that does not exist or to a value it cannot have, when a wire
  /// joins what does not exist, when there is no chip or pin to trace, when a device has no serial
  /// interface of a given name, or when the state directory or a file in it cannot be used.
  Rack(const RackConfiguration& configuration, EventLog& log);
  ~Rack();
  Rack(const Rack&) = delete;
  Rack& operator=(const Rack&) = delete;

  /// Sends `frame` through the segment's slaves, in place, at `arrival`, from the master's
  /// interface `entry`. Returns the interface at which it comes out; nothing: nobody answers it.
  std::optional<ethercat::MasterInterface> process_frame(
      std::size_t segment, std::span<std::byte> frame, base::SimTime arrival,
      ethercat::MasterInterface entry = ethercat::MasterInterface::primary);

  /// Lets the firmware of the segment's devices take what its last frame brought.
  void handle_bus_events(std::size_t segment, base::SimTime now);

  /// Brings every device and bus to `now`, once devices have heard what became of all they ordered
  /// to be kept (DeviceStorage::Completions::before_time_moves), stopping at each event of the
  /// timetable, at each instant at which wires act and at each sampling instant of the recording on
  /// the way.
  void advance(base::SimTime now);

  /// Lets devices hear at `now` what has become of what they ordered to be kept, as far as it is
  /// known (DeviceStorage::Completions::when_durable).
  void hand_over_completions(base::SimTime now);
  /// Lets a device hear what a recording says of it (DeviceStorage::Completions::recorded). False:
  /// the rack has no such memory.
  bool complete(const StorageCompletion& completion, base::SimTime now);

  /// The next moment at which something happens on a CAN bus on its own: a frame ends, a device
  /// sends. advance() need not stop there, but what comes of it is to go out then.
  [[nodiscard]] base::SimTime next_bus_deadline() const;

  /// The next moment at which a serial line or one of its devices has something to send, or
  /// something happens to the rack.
  [[nodiscard]] base::SimTime next_line_deadline(std::size_t line) const;

  /// Lockstep: lets the replies pass to what came over a serial line. `clock` moves on as far as
  /// that takes.
  void settle_line(std::size_t line, LockstepClock& clock);

  /// Lockstep: lets the frames pass that wait on the bus, and those that follow from them at once.
  /// `clock` moves on as far as that takes, which is not at all on an unlimited bus.
  void settle(std::size_t bus, LockstepClock& clock);

  /// Lets `event` happen at `now`, to which the rack has been brought. Throws std::runtime_error
  /// for an input that does not exist or a value it cannot have.
  void apply(const RackEvent& event, base::SimTime now);

  /// A fault, which `owner` stands for, holds an input, a cable or a supply as `event` has it from
  /// now on, whatever else sets it. Throws as apply() does. The newest of several is in force.
  /// `Event`: InputEvent, CableEvent or PowerEvent.
  template <typename Event>
  void hold(const Event& event, const void* owner, base::SimTime now);
  /// That is over: what `event` names gets what an older fault wants of it, else what was set last.
  template <typename Event>
  void release(Event event, const void* owner, base::SimTime now);

  /// What an input of a device has been set to and, under a fault, is held at. Nothing: it never
  /// has.
  [[nodiscard]] std::optional<double> input_value(
      const std::pair<DeviceAddress, std::string>& input) const;

  /// Hands a frame of a program to a bus through its `number`th port. False: the port has no room.
  bool put(std::size_t bus, std::size_t number, can::Port& port, const can::Frame& frame);
  /// Takes the oldest frame that waits at a port.
  std::optional<can::TimedFrame> take(std::size_t bus, std::size_t number, can::Port& port);
  /// Bytes of a program come over a serial line at `now`, to which the rack has been brought.
  void put(std::size_t line, std::span<const std::byte> bytes, base::SimTime now);

  /// Tells `journal` of all that is done to the rack from now on; null: nobody.
  void set_journal(Journal* journal);
  [[nodiscard]] Journal* journal();
  /// A frame that a fault has held up and that comes out at `now` or earlier gets into `buffer`
  /// (ethercat::kMaximumFrameLength bytes). Nothing: none does. Its firmware takes what it brought.
  std::optional<ethercat::ReleasedFrame> release_frame(std::size_t segment, base::SimTime now,
                                                       std::span<std::byte> buffer);

  /// Arms a fault at `now`, to which the rack has been brought. Returns its number, or why it
  /// cannot be.
  base::Expected<std::uint64_t, std::string> inject(const FaultConfiguration& fault,
                                                    base::SimTime now);
  /// Ends the fault of this number; nothing: all. Returns how many ended.
  std::size_t clear_faults(std::optional<std::uint64_t> id, base::SimTime now);
  /// What goes wrong with the rack on demand.
  [[nodiscard]] Faults& faults() { return *faults_; }

  /// A network interface of the segment's master got or lost its carrier. At the start the primary
  /// has one, the secondary has none.
  void set_carrier(std::size_t segment, ethercat::MasterInterface interface, bool up,
                   base::SimTime now);

  [[nodiscard]] std::size_t segment_count() const;
  [[nodiscard]] const ethercat::Segment& segment(std::size_t index) const;
  [[nodiscard]] ethercat::Segment& segment(std::size_t index);
  [[nodiscard]] std::span<NamedDevice> devices(std::size_t segment);
  [[nodiscard]] std::size_t bus_count() const;
  [[nodiscard]] CanNetwork& bus(std::size_t index);
  [[nodiscard]] const CanNetwork& bus(std::size_t index) const;
  /// For events that happen to a device from outside.
  [[nodiscard]] base::EventReporter reporter(DeviceAddress device);
  /// For events of the bus itself and of its ports.
  [[nodiscard]] base::EventReporter bus_reporter(std::size_t index);
  [[nodiscard]] std::size_t line_count() const;
  /// Those the devices' configurations name, in the order in which they do.
  [[nodiscard]] SerialLine& line(std::size_t index);
  [[nodiscard]] const SerialLine& line(std::size_t index) const;
  /// Every device, those of segments first, in the order of their numbers in events of one network.
  [[nodiscard]] std::vector<DeviceAddress> addresses() const;
  [[nodiscard]] const std::string& name_of(DeviceAddress device);
  [[nodiscard]] product::Device& device(DeviceAddress device);
  [[nodiscard]] const std::vector<product::Input>& inputs(DeviceAddress device) const;
  [[nodiscard]] bool powered(DeviceAddress device) const;
  /// What the device's objects are protected by; pre_operational also stands for states below.
  [[nodiscard]] dictionary::NetworkState network_state(DeviceAddress device);

  /// Reads an entry of the device's object dictionary as an SDO would; `value` gets its bytes.
  [[nodiscard]] dictionary::Verdict read_object(DeviceAddress device, dictionary::Entry& entry,
                                                std::vector<std::byte>& value);
  /// Writes one as an SDO would, with all its checks, and lets the firmware act on it at `now`, to
  /// which the rack has been brought. What was written is an event.
  [[nodiscard]] dictionary::Verdict write_object(DeviceAddress device, dictionary::Entry& entry,
                                                 std::span<const std::byte> value,
                                                 base::SimTime now);
  /// What an SDO that wrote `entry` would be answered at `now`; nothing: what the write began, such
  /// as storing parameters, is still under way. Only looks, and may be asked again and again.
  [[nodiscard]] std::optional<dictionary::Verdict> completion_of_write(
      DeviceAddress device, const dictionary::Entry& entry, base::SimTime now);

  /// Samples the tap's signals from `now` on, until it is removed.
  void add(SignalTap& tap, base::SimTime now);
  void remove(const SignalTap& tap);
  /// Copies all that passes over the networks into `tap` from now on; null: nothing.
  void watch_traffic(TrafficTap* tap);

  /// All signals of all devices, named "device.signal", and of all buses.
  [[nodiscard]] std::vector<product::Signal> signals() const;
  /// The recording; null without one.
  [[nodiscard]] const Recorder* recorder() const;
  /// The logic analyser; null without one.
  [[nodiscard]] PinTrace* trace();
  /// Where devices keep what outlives power; null if nothing is kept.
  [[nodiscard]] DeviceStorage* storage();
  /// See EventLog::settle().
  void settle_log(base::SimTime now);

  /// All that is written while the rack runs. Recording, trace and the files of buses are among
  /// them from the beginning.
  [[nodiscard]] OutputFiles& outputs();
  [[nodiscard]] const OutputFiles& outputs() const;
  /// What events call a device.
  [[nodiscard]] std::uint16_t number_of(DeviceAddress device) const;

 private:
  struct Parts;

  std::optional<ethercat::MasterInterface> pass_frame(std::size_t segment,
                                                      std::span<std::byte> frame,
                                                      base::SimTime arrival,
                                                      ethercat::MasterInterface entry);
  void connect_wires(const RackConfiguration& configuration);
  void advance_at_once(base::SimTime now);
  void advance_with_storage(base::SimTime now);
  void wait_for_completions();
  void advance_to(base::SimTime now);
  void take_bus_events(std::size_t segment, base::SimTime now);
  /// Who is to be told of a call: nobody of one that another call makes.
  [[nodiscard]] Journal* told();

  std::unique_ptr<Parts> parts_;
  std::unique_ptr<Faults> faults_;  ///< go first: they know everything
};

}  // namespace stator::rack
