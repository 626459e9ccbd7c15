#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "devices/ethercat_device.hpp"
#include "rack/rack_configuration.hpp"
#include "rack/toml_section.hpp"

namespace stator::rack {

/// Reads the [[event]] tables of a rack file against the segments that stand in it.
class EventSectionReader {
 public:
  /// `segments` must outlive the reader.
  explicit EventSectionReader(std::span<const SegmentConfiguration> segments)
      : segments_(segments) {}

  /// Reads one [[event]], its time, its action and what the action acts upon, and appends what it
  /// makes happen. Throws RackFileError for a device, port, cable or input that is not in the rack.
  void read(TomlSection& section, std::vector<EventConfiguration>& events);

 private:
  using Inputs = std::vector<devices::Input>;

  [[nodiscard]] DeviceAddress read_target(TomlSection& section) const;
  [[nodiscard]] RackEvent read_cable(TomlSection& section, bool intact) const;
  void read_set(TomlSection& section, base::SimDuration at,
                std::vector<EventConfiguration>& events);
  [[nodiscard]] const Inputs& inputs_of(DeviceAddress device);

  std::span<const SegmentConfiguration> segments_;
  /// By segment and device; names and ranges only, since the devices asked for them are gone.
  std::map<std::pair<std::size_t, std::size_t>, Inputs> inputs_;
};

}  // namespace stator::rack
