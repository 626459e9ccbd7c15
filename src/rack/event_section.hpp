#pragma once

#include <map>
#include <string>
#include <vector>

#include "devices/input.hpp"
#include "rack/rack_configuration.hpp"
#include "rack/toml_section.hpp"

namespace stator::rack {

/// Reads the [[event]] tables of a rack file against the segments and buses that stand in it.
class EventSectionReader {
 public:
  /// `rack` must outlive the reader.
  explicit EventSectionReader(const RackConfiguration& rack) : rack_(rack) {}

  /// Reads one [[event]], its time, its action and what the action acts upon, and appends what it
  /// makes happen. Throws RackFileError for a device, port, cable or input that is not in the rack.
  void read(TomlSection& section, std::vector<EventConfiguration>& events);

 private:
  using Inputs = std::vector<devices::Input>;

  [[nodiscard]] DeviceAddress read_target(TomlSection& section) const;
  [[nodiscard]] DeviceAddress read_can_target(TomlSection& section) const;
  void require_can(TomlSection& section, DeviceAddress target) const;
  [[nodiscard]] unsigned read_port(TomlSection& section, DeviceAddress target) const;
  [[nodiscard]] RackEvent read_cable(TomlSection& section, bool intact) const;
  [[nodiscard]] RackEvent read_frame_fault(TomlSection& section, can::FrameFaultKind kind) const;
  [[nodiscard]] RackEvent read_segment_fault(TomlSection& section, DeviceAddress target,
                                             can::FrameFaultKind kind) const;
  [[nodiscard]] std::size_t read_bus(TomlSection& section, const std::string& name) const;
  void read_set(TomlSection& section, base::SimDuration at,
                std::vector<EventConfiguration>& events);
  [[nodiscard]] const DeviceConfiguration& device_at(DeviceAddress address) const;
  [[nodiscard]] const Inputs& inputs_of(DeviceAddress device);

  const RackConfiguration& rack_;
  /// Names and ranges only, since the devices asked for them are gone.
  std::map<DeviceAddress, Inputs> inputs_;
};

}  // namespace stator::rack
