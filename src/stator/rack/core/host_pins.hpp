#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "stator/base/sim_time.hpp"
#include "stator/product/device/host_port.hpp"
#include "stator/rack/world/device_address.hpp"

namespace stator::rack {

class Rack;

/// The pins of a chip of a rack for the controller beside it. What that does to them is in the
/// rack's journal, with what the chip answers.
class HostPins final : public product::HostPort {
 public:
  /// Of `device`, which is on a segment; see exist(). `rack` must outlive the pins.
  HostPins(Rack& rack, DeviceAddress device) : rack_(rack), device_(device) {}

  /// False: the device has its own firmware and no pins for one beside it.
  [[nodiscard]] static bool exist(Rack& rack, DeviceAddress device);

  void select(product::HostSpi spi) override;
  void transfer(product::HostSpi spi, std::span<const std::byte> mosi, std::span<std::byte> miso,
                std::optional<base::SimDuration> read_pause) override;
  void deselect(product::HostSpi spi, unsigned surplus_clocks) override;
  [[nodiscard]] product::HostLines levels() override;
  void watch(product::HostLines watched, product::HostLineSink* sink) override;
  [[nodiscard]] base::SimTime next_line_change() override;
  void set_pin(product::HostPin pin, bool level) override;

 private:
  [[nodiscard]] static product::HostPort* port_of(Rack& rack, DeviceAddress device);

  Rack& rack_;
  DeviceAddress device_;
};

}  // namespace stator::rack
