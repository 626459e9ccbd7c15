#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/can/bus.hpp"
#include "stator/can/port.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/rack/networks/bus_configuration.hpp"
#include "stator/rack/observe/can_tap.hpp"
#include "stator/rack/observe/traffic_tap.hpp"
#include "stator/rack/world/rack_event.hpp"

namespace stator::rack {

/// A device on a CAN bus with the name people gave it.
struct NamedCanDevice {
  std::string name;
  std::unique_ptr<product::CanDevice> device;
};

/// A CAN bus with its devices and ports. Passive: whoever feeds the ports brings the time.
///
/// On its way through time it stops wherever a frame ends or a device acts on its own. A device is
/// brought to such a moment only if it gets a frame then, all others when the whole way is done:
/// they run in periods of their own, so they do not notice.
class CanNetwork {
 public:
  /// Throws std::runtime_error when its log or capture cannot be opened.
  explicit CanNetwork(const BusConfiguration& configuration);

  /// Adds a device, which becomes the next in devices(); `reporter` tells of its error states.
  void add(NamedCanDevice device, const base::EventReporter& reporter);
  /// Attaches a port until it is removed.
  void add(can::Port& port) { bus_.add(port); }
  void remove(const can::Port& port) { bus_.remove(port); }

  /// Brings bus and devices to `now`.
  void advance(base::SimTime now);
  /// The next moment at which a frame ends or a device acts on its own.
  [[nodiscard]] base::SimTime next_deadline() const {
    return std::min(earliest_, bus_.next_deadline());
  }

  /// The same of one device.
  [[nodiscard]] base::SimTime deadline_of(std::size_t device) const { return deadlines_[device]; }
  /// Where advance() has come, or is at present.
  [[nodiscard]] base::SimTime now() const { return now_; }

  /// Does one of what the events of a rack can do to a device; `now` is where advance() has come.
  void set_connected(std::size_t device, bool connected);
  void set_power(std::size_t device, bool on, base::SimTime now);
  [[nodiscard]] bool powered(std::size_t device) const { return bus_.powered(members_[device]); }
  void set_error_state(std::size_t device, can::ErrorState state, base::SimTime now);
  /// Returns the fault's number at bus().
  std::uint64_t inject(const FrameFaultEvent& event);
  void withdraw(std::uint64_t fault) { bus_.withdraw(fault); }
  /// What the time stamps of log and capture add to simulated time from now on.
  void set_epoch(base::SimDuration epoch) { tap_.set_epoch(epoch); }
  /// Adds log and capture to `outputs`; `number` is the bus's in events about these files.
  void add_files_to(OutputFiles& outputs, std::uint16_t number) { tap_.add_to(outputs, number); }
  /// Copies all that is on the wire into `tap` as `network`; null: nothing.
  void watch_traffic(TrafficTap* tap, std::uint16_t network);
  /// Tells `observer` of everything on the wire as well; empty ends that.
  void observe(base::Delegate<void(const can::TraceEntry&)> observer);
  /// Something about the device was changed from outside.
  void touched(std::size_t device) { refresh(device, now_); }

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const can::Bus& bus() const { return bus_; }
  [[nodiscard]] std::span<NamedCanDevice> devices() { return devices_; }
  [[nodiscard]] std::span<const NamedCanDevice> devices() const { return devices_; }
  [[nodiscard]] std::size_t member_of(std::size_t device) const { return members_[device]; }
  /// What can be recorded of the bus itself: load, frames, error frames.
  [[nodiscard]] std::vector<product::Signal> signals() const;

 private:
  void look_at_wire();
  void trace(const can::TraceEntry& entry);
  void serve_reached();
  void serve(std::size_t device, base::SimTime now);
  void refresh(std::size_t device, base::SimTime now);
  void find_earliest();
  [[nodiscard]] double load() const { return bus_.load(now_); }
  [[nodiscard]] double frames() const { return static_cast<double>(bus_.statistics().frames); }
  [[nodiscard]] double error_frames() const {
    return static_cast<double>(bus_.statistics().error_frames);
  }

  std::string name_;
  std::vector<NamedCanDevice> devices_;
  std::vector<std::size_t> members_;      ///< by device: its number as a member of the bus
  std::vector<std::size_t> device_of_;    ///< by member of the bus that is a device
  std::vector<base::SimTime> deadlines_;  ///< by device
  base::SimTime earliest_ = base::SimTime::never();  ///< of the deadlines
  bool earliest_stale_ = false;                      ///< the earliest one may be later now
  base::SimTime now_;
  CanTap tap_;
  base::Delegate<void(const can::TraceEntry&)> observer_;
  can::Bus bus_;  ///< destroyed first: it refers to the devices' controllers
};

}  // namespace stator::rack
