#include "stator/devices/junction/keys.hpp"

#include <array>

namespace stator::devices {

namespace {

constexpr std::array kJunctionRows{
    settings::whole<&JunctionConfiguration::ports>("ports", {3, 4},
                                                   "How many it has for cables, numbered from 0"),
    settings::whole<&JunctionConfiguration::station_alias>("alias", {0, 0xFFFF},
                                                           "Configured station alias (SII word 4)"),
    settings::whole<&JunctionConfiguration::serial_number>("serial_number", {0, 0xFFFFFFFF},
                                                           "Identity in the EEPROM"),
    settings::whole<&JunctionConfiguration::clock_deviation_ppb>(
        "clock_deviation_ppb", {-1'000'000, 1'000'000, "ppb"}, "Error of its oscillator"),
};

}  // namespace

constinit const settings::Section<JunctionConfiguration> kJunctionKeys{kJunctionRows};

}  // namespace stator::devices
