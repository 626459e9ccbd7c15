#pragma once

#include <map>
#include <string>
#include <vector>

#include "stator/product/device/input.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// Reads what of a rack something happens to: devices, ports, buses, inputs. All throw
/// RackFileError for what is not in the rack.
class TargetReader {
 public:
  /// `rack` must outlive the reader.
  explicit TargetReader(const RackConfiguration& rack) : rack_(rack) {}

  /// The device that `device` names.
  [[nodiscard]] DeviceAddress read_target(TomlSection& section) const;
  /// The same on a CAN bus with a wire.
  [[nodiscard]] DeviceAddress read_can_target(TomlSection& section) const;
  void require_can(TomlSection& section, DeviceAddress target) const;
  /// A port of an EtherCAT device with a cable, by default the one it is reached through.
  [[nodiscard]] unsigned read_port(TomlSection& section, DeviceAddress target) const;
  [[nodiscard]] std::size_t read_bus(TomlSection& section, const std::string& name) const;
  [[nodiscard]] const DeviceConfiguration& device_at(DeviceAddress address) const;
  /// Names and ranges only, since the devices asked for them are gone.
  [[nodiscard]] const std::vector<product::Input>& inputs_of(DeviceAddress device);

 private:
  const RackConfiguration& rack_;
  std::map<DeviceAddress, std::vector<product::Input>> inputs_;
};

}  // namespace stator::rack
