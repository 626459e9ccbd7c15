#include "stator/devices/generic/keys.hpp"

#include <array>

#include "stator/plant/keys/pwm_axis_keys.hpp"
#include "stator/product/shell/coe_keys.hpp"
#include "stator/product/shell/quirk_keys.hpp"

namespace stator::devices::generic {

namespace {

/// Of all that have drives.
template <typename Configuration>
constexpr auto drive_rows() {
  return std::array{
      settings::whole<&Configuration::units, &DriveUnits::position>(
          "position_units", {0, 0xFFFFFFFF},
          "Of 6064h and the like in a revolution of the motor; 0: as 608Fh, 6091h and 6092h say, "
          "else 65536"),
      settings::number<&Configuration::units, &DriveUnits::velocity>(
          "velocity_units", {0.0, 1e9},
          "Of 606Ch and the like in a revolution per second, 60 for rpm; 0: as many as of "
          "position"),
      settings::sections<plant::kPwmAxisKeys, &Configuration::axes>(
          "axis", "axes", "What is connected to a drive, axis 0 first"),
  };
}

constexpr std::array kSlaveRows = settings::rows(
    std::array{
        settings::keys<product::kCoeQuirkKeys, &SlaveConfiguration::quirks>(),
        settings::whole<&SlaveConfiguration::coe, &product::CoeOptions::station_alias>(
            "alias", {0, 0xFFFF}, "Configured station alias (SII word 4)"),
        settings::whole<&SlaveConfiguration::serial_number>("serial_number", {0, 0xFFFFFFFF},
                                                            "1018h:04 and SII"),
        settings::keys<product::kCoeKeys, &SlaveConfiguration::coe>(),
    },
    drive_rows<SlaveConfiguration>());

constexpr std::array kTerminalRows{
    settings::whole<&TerminalConfiguration::station_alias>("alias", {0, 0xFFFF},
                                                           "Configured station alias (SII word 4)"),
    settings::whole<&TerminalConfiguration::serial_number>("serial_number", {0, 0xFFFFFFFF}, "SII"),
    settings::whole<&TerminalConfiguration::clock_deviation_ppb>(
        "clock_deviation_ppb", {-1'000'000, 1'000'000, "ppb"}, "Error of its oscillator"),
};

constexpr std::array kNodeRows = settings::rows(
    std::array{
        settings::whole<&NodeConfiguration::node_id>("node_id", {1, 127},
                                                     "Of the device on its bus"),
        settings::whole<&NodeConfiguration::bit_rate>("bit_rate", {10'000, 1'000'000, "bit/s"},
                                                      "Of its CAN controller"),
        settings::keys<product::kCanopenQuirkKeys, &NodeConfiguration::quirks>(),
        settings::whole<&NodeConfiguration::serial_number>("serial_number", {0, 0xFFFFFFFF},
                                                           "1018h:04"),
    },
    drive_rows<NodeConfiguration>());

}  // namespace

constinit const settings::Section<SlaveConfiguration> kSlaveKeys{kSlaveRows};
constinit const settings::Section<TerminalConfiguration> kTerminalKeys{kTerminalRows};
constinit const settings::Section<NodeConfiguration> kNodeKeys{kNodeRows};

}  // namespace stator::devices::generic
