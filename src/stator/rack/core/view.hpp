#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/dictionary/declaration.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/rack/world/device_address.hpp"

namespace stator::ethercat {
class Segment;
}
namespace stator::product {
class CanDevice;
class Device;
class EtherCatDevice;
}  // namespace stator::product

namespace stator::rack {

class CanNetwork;
class OutputFiles;
class Recorder;
class SerialLine;
struct FaultStatus;
struct RackParts;

/// A read-only view of a rack: nothing that is reached from here can be changed, so reading never
/// shows in a recording. Not thread-safe.
class View {
 public:
  View(const View&) = delete;
  View& operator=(const View&) = delete;

  [[nodiscard]] std::size_t segment_count() const;
  [[nodiscard]] const ethercat::Segment& segment(std::size_t index) const;
  [[nodiscard]] std::size_t bus_count() const;
  [[nodiscard]] const CanNetwork& bus(std::size_t index) const;
  [[nodiscard]] std::size_t line_count() const;
  /// Those the devices' configurations name, in the order in which they do.
  [[nodiscard]] const SerialLine& line(std::size_t index) const;

  /// Every device, those of segments first, in the order of their numbers in events of one network.
  [[nodiscard]] std::vector<DeviceAddress> addresses() const;
  [[nodiscard]] const std::string& name_of(DeviceAddress device) const;
  /// What events call a device.
  [[nodiscard]] std::uint16_t number_of(DeviceAddress device) const;
  [[nodiscard]] const product::Device& device(DeviceAddress device) const;
  /// `device` is on a segment.
  [[nodiscard]] const product::EtherCatDevice& slave(DeviceAddress device) const;
  /// `device` is on a bus.
  [[nodiscard]] const product::CanDevice& node(DeviceAddress device) const;
  [[nodiscard]] bool powered(DeviceAddress device) const;
  /// The network state that decides which objects of the device may be written; pre_operational
  /// also stands for the states below.
  [[nodiscard]] dictionary::NetworkState network_state(DeviceAddress device) const;

  /// What can be set around a device, and in which range.
  [[nodiscard]] const std::vector<product::InputRange>& inputs(DeviceAddress device) const;
  /// The value at which a fault holds an input of a device, or to which it was set last. Nothing:
  /// it was never set.
  [[nodiscard]] std::optional<double> input_value(
      const std::pair<DeviceAddress, std::string>& input) const;
  /// All signals of all devices, named "device.signal", and of all buses.
  [[nodiscard]] std::vector<product::Signal> signals() const;
  /// Faults that wait or are active at `now`, and the last ones that are over; the oldest first.
  [[nodiscard]] std::vector<FaultStatus> faults(base::SimTime now) const;

  /// The next moment at which something happens on a CAN bus on its own: a frame ends, a device
  /// sends. Rack::advance() need not stop there, but what comes of it is to go out then.
  [[nodiscard]] base::SimTime next_bus_deadline() const;
  /// The next moment at which a serial line or one of its devices has something to send, or
  /// something happens to the rack.
  [[nodiscard]] base::SimTime next_line_deadline(std::size_t line) const;

  /// The recording; null without one.
  [[nodiscard]] const Recorder* recorder() const;
  [[nodiscard]] const OutputFiles& outputs() const;

 protected:
  explicit View(std::unique_ptr<RackParts> parts);
  ~View();

  std::unique_ptr<RackParts> parts_;
};

}  // namespace stator::rack
