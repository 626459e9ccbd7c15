#pragma once

#include "stator/devices/tmc8670/configuration.hpp"
#include "stator/ethercat/controller/slave_controller_configuration.hpp"
#include "stator/ethercat/stack/slave_stack.hpp"
#include "stator/ethercat/standard/device_description.hpp"

namespace stator::devices::tmc8670 {

/// What the chip tells a master of itself, for its EEPROM and its ESI file.
[[nodiscard]] ethercat::DeviceDescription describe(const Tmc8670Configuration& configuration);

[[nodiscard]] ethercat::SlaveStackOptions stack_options(const Tmc8670Configuration& configuration);

/// Throws std::logic_error if there is no preset of that name.
[[nodiscard]] ethercat::SlaveControllerConfiguration controller_of(
    const Tmc8670Configuration& configuration);

}  // namespace stator::devices::tmc8670
