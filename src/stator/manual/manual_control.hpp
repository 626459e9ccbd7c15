#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/manual/command.hpp"
#include "stator/manual/device_status.hpp"
#include "stator/manual/session.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/run/runner.hpp"
#include "stator/rack/world/device_address.hpp"

namespace stator::manual {

/// Lets a person move the axes of a running rack by hand, with no master beside it: a small master
/// inside the process for EtherCAT, CANopen and TMCL, which is started for a device and steps aside
/// the moment another one speaks on the network. All calls return at once and may come from any
/// thread; what they asked for is done in a thread for each network.
///
/// Needs the machine's clock: in lockstep time is the master's.
class ManualControl {
 public:
  /// `runner` runs a rack that was built from `configuration`; `log` gets its events. All outlive
  /// this.
  ManualControl(rack::Runner& runner, const rack::RackConfiguration& configuration,
                rack::EventLog& log);
  ~ManualControl();
  ManualControl(const ManualControl&) = delete;
  ManualControl& operator=(const ManualControl&) = delete;

  /// Why the axes of a device cannot be moved by hand; empty: they can.
  [[nodiscard]] std::string impediment(rack::DeviceAddress device) const;
  [[nodiscard]] DeviceStatus status(rack::DeviceAddress device) const;

  /// Begins with a device, also with one that has process data but no axes. Does nothing if it is
  /// under manual control already.
  base::Expected<void, std::string> start(rack::DeviceAddress device);
  /// Gives a device back: its axes lose their current, its network is left as it was found.
  void release(rack::DeviceAddress device);
  /// Has an axis of a device that is Phase::active do something. What the device answers shows in
  /// status().
  base::Expected<void, std::string> command(rack::DeviceAddress device, std::size_t axis,
                                            const Command& command);

  /// Writes output process data of a device without axes that is Phase::active, from `offset` on.
  base::Expected<void, std::string> set_outputs(rack::DeviceAddress device, std::size_t offset,
                                                std::vector<std::byte> data);

  /// Ends at once, without a word to the devices, and waits for the threads; nothing begins any
  /// more. To be called before the runner is stopped.
  void stop();

 private:
  enum class Medium : std::uint8_t { segment, bus, line };
  /// A network of the rack.
  struct Place {
    Medium medium = Medium::segment;
    std::size_t index = 0;
    friend auto operator<=>(const Place&, const Place&) = default;
  };
  /// How a device is reached, or why it is not.
  [[nodiscard]] base::Expected<Place, std::string> place_of(rack::DeviceAddress device) const;
  [[nodiscard]] const rack::DeviceConfiguration& configuration_of(rack::DeviceAddress device) const;
  [[nodiscard]] std::unique_ptr<Session> make_session(Place place, rack::DeviceAddress first);

  rack::Runner& runner_;
  const rack::RackConfiguration& configuration_;
  rack::EventLog& log_;
  std::vector<rack::DeviceAddress> devices_;
  mutable std::mutex mutex_;  ///< guards all below
  bool stopped_ = false;
  std::map<Place, std::unique_ptr<Session>> sessions_;
};

}  // namespace stator::manual
