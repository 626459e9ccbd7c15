#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stator/base/delegate.hpp"
#include "stator/base/event.hpp"
#include "stator/base/expected.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/dictionary/refusal.hpp"
#include "stator/ethercat/segment/released_frame.hpp"
#include "stator/ethercat/segment/topology.hpp"
#include "stator/rack/core/view.hpp"
#include "stator/rack/world/device_address.hpp"
#include "stator/rack/world/rack_event.hpp"

namespace stator::dictionary {
class Entry;
}

namespace stator::rack {

class Coupling;
class DeviceStorage;
class EventLog;
class Journal;
class LockstepClock;
class OutputFiles;
class PinTrace;
class SignalTap;
class TrafficTap;
struct Command;
struct EoeOutput;
struct FaultConfiguration;
struct RackConfiguration;
struct StorageCompletion;

/// All devices of one process and their recording. Passive: whoever owns a link or a master brings
/// frames and time. What is done to it goes through these functions and no other way, so that its
/// journal is told of everything; what can be seen of it is its View. Not thread-safe.
class Rack : public View {
 public:
  /// Builds every device. `log` gets their events and must outlive the rack. Throws
  /// std::runtime_error when the recording cannot be opened or names signals that do not exist,
  /// when an event sets an input that does not exist or to a value it cannot have, when a wire
  /// joins what does not exist, when there is no chip or pin to trace, when a device has no serial
  /// interface of a given name, or when the state directory or a file in it cannot be used.
  Rack(const RackConfiguration& configuration, EventLog& log);
  ~Rack();

  /// Does what `command` says, as the function of its own does that there may be for it, and drops
  /// what that returns. What the command names must exist.
  void execute(const Command& command);

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

  /// Tells devices at `now` which of their orders to keep something have been carried out or have
  /// failed, as far as that is known (DeviceStorage::Completions::when_durable).
  void hand_over_completions(base::SimTime now);
  /// Tells a device the end of an order as a recording has it
  /// (DeviceStorage::Completions::recorded). False: the rack has no such memory.
  bool complete(const StorageCompletion& completion, base::SimTime now);

  /// Lockstep: advances the rack and `clock` until the replies to what came over a serial line have
  /// passed.
  void settle_line(std::size_t line, LockstepClock& clock);

  /// Lockstep: advances the rack and `clock` until the frames that wait on the bus have passed, and
  /// those that devices send at once in answer. An unlimited bus takes no time for that.
  void settle(std::size_t bus, LockstepClock& clock);

  /// Lets `event` happen at `now`, to which the rack has been brought. Throws std::runtime_error
  /// for an input that does not exist or a value it cannot have.
  void apply(const RackEvent& event, base::SimTime now);

  /// Bytes of a program come over a serial line at `now`, to which the rack has been brought.
  void put(std::size_t line, std::span<const std::byte> bytes, base::SimTime now);
  /// Where bytes for programs go from now on that come out of a serial line; empty: they are lost.
  void connect_line(std::size_t line, base::Delegate<void(std::span<const std::byte>)> output);

  /// A frame of the network behind a device's EoE comes to its port. Of more than the device's
  /// firmware fetches in time the oldest are dropped and counted.
  void put_eoe_frame(DeviceAddress device, std::span<const std::byte> frame);
  /// Where frames of the master for that network go from now on. False: the device has no EoE, or
  /// none that its configuration bridges.
  bool connect_eoe(DeviceAddress device, const EoeOutput& output);

  /// Tells `journal` of all that is done to the rack from now on; null: nobody.
  void set_journal(Journal* journal);
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

  /// A network interface of the segment's master got or lost its carrier. At the start the primary
  /// has one, the secondary has none.
  void set_carrier(std::size_t segment, ethercat::MasterInterface interface, bool up,
                   base::SimTime now);

  /// For events of a bus and of its ports.
  [[nodiscard]] base::EventReporter bus_reporter(std::size_t index);
  /// What the time stamps of a bus's log and capture add to simulated time from now on.
  void set_bus_epoch(std::size_t bus, base::SimDuration epoch);

  /// Reads an entry of the device's object dictionary as an SDO would; `value` gets its bytes.
  [[nodiscard]] dictionary::Verdict read_object(DeviceAddress address,
                                                const dictionary::Entry& entry,
                                                std::vector<std::byte>& value);
  /// Writes one as an SDO would, with all its checks, and lets the firmware act on it at `now`, to
  /// which the rack has been brought. `entry` is as the device shows it to who looks, and says only
  /// which one is meant. What was written is an event.
  [[nodiscard]] dictionary::Verdict write_object(DeviceAddress address,
                                                 const dictionary::Entry& entry,
                                                 std::span<const std::byte> value,
                                                 base::SimTime now);
  /// What an SDO that wrote `entry` would be answered at `now`; nothing: what the write began, such
  /// as storing parameters, is still under way. Only looks, and may be asked again and again.
  [[nodiscard]] std::optional<dictionary::Verdict> completion_of_write(
      DeviceAddress address, const dictionary::Entry& entry, base::SimTime now);

  /// Lets `coupling` act from now on, beside the rack's wires. Throws std::runtime_error when it
  /// wants what devices have not.
  void couple(std::unique_ptr<Coupling> coupling);

  /// Samples the tap's signals from `now` on, until it is removed.
  void add(SignalTap& tap, base::SimTime now);
  void remove(const SignalTap& tap);
  /// Copies all that passes over the networks into `tap` from now on; null: nothing.
  void watch_traffic(TrafficTap* tap);

  // What is written beside the simulation, which nothing here can change.

  /// The logic analyser; null without one.
  [[nodiscard]] PinTrace* trace();
  /// Where devices keep what outlives power; null if nothing is kept.
  [[nodiscard]] DeviceStorage* storage();
  /// See EventLog::settle().
  void settle_log(base::SimTime now);
  /// All that is written while the rack runs. Recording, trace and the files of buses are among
  /// them from the beginning.
  using View::outputs;
  [[nodiscard]] OutputFiles& outputs();

 private:
  friend class BusPort;
  friend class HostPins;

  std::optional<ethercat::MasterInterface> pass_frame(std::size_t segment,
                                                      std::span<std::byte> frame,
                                                      base::SimTime arrival,
                                                      ethercat::MasterInterface entry);
  void advance_at_once(base::SimTime now);
  void advance_with_storage(base::SimTime now);
  void wait_for_completions();
  void advance_to(base::SimTime now);
  void take_bus_events(std::size_t segment, base::SimTime now);
  class Execution;
  /// The journal that has to record a call; null for a call that another call of the rack makes.
  [[nodiscard]] Journal* listening();
  /// Records a command in the journal, if there is one, before the command is carried out.
  template <typename Alternative>
  void tell(const Alternative& command);
};

}  // namespace stator::rack
