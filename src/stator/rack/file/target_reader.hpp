#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stator/product/device/input.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/file/table_reader.hpp"

namespace stator::rack {

/// Reads what of a rack something happens to: devices, ports, buses, inputs. What is not in the
/// rack ends reading (TableReader::fail); where a table is described, there is nothing to be in it.
class TargetReader {
 public:
  /// `rack` must outlive the reader.
  explicit TargetReader(const RackConfiguration& rack) : rack_(rack) {}

  /// The device that `device` names.
  [[nodiscard]] DeviceAddress read_target(TableReader& section) const;
  /// The same where the key has been read: it is `name`, or not there.
  [[nodiscard]] DeviceAddress find_device(TableReader& section,
                                          const std::optional<std::string>& name) const;
  /// The same on a CAN bus with a wire.
  [[nodiscard]] DeviceAddress read_can_target(TableReader& section) const;
  void require_can(TableReader& section, DeviceAddress target) const;
  /// A port of an EtherCAT device with a cable, by default the one it is reached through.
  [[nodiscard]] unsigned read_port(TableReader& section, DeviceAddress target) const;
  [[nodiscard]] std::size_t read_bus(TableReader& section, const std::string& name) const;
  [[nodiscard]] const DeviceConfiguration& device_at(DeviceAddress address) const;
  /// The inputs of a device without access to them: the device was made only to be asked.
  [[nodiscard]] const std::vector<product::InputRange>& inputs_of(DeviceAddress device);

 private:
  const RackConfiguration& rack_;
  std::map<DeviceAddress, std::vector<product::InputRange>> inputs_;
};

}  // namespace stator::rack
