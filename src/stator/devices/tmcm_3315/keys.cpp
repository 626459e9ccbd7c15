#include "stator/devices/tmcm_3315/keys.hpp"

#include <array>
#include <cstdint>

#include "stator/plant/keys/stepper_axis_keys.hpp"
#include "stator/product/shell/coe_keys.hpp"
#include "stator/product/shell/quirk_keys.hpp"

namespace stator::devices {

namespace tmcm_3315 {

namespace {

constexpr std::array kFirmwareVersions{
    settings::Word{"1.07", static_cast<std::int64_t>(FirmwareVersion::v1_07)},
    settings::Word{"1.08", static_cast<std::int64_t>(FirmwareVersion::v1_08)},
    settings::Word{"1.09", static_cast<std::int64_t>(FirmwareVersion::v1_09)},
};

constexpr std::array kModuleRows{
    settings::keys<product::kCoeQuirkKeys, &Tmcm3315Configuration::quirks>(),
    settings::whole<&Tmcm3315Configuration::coe, &product::CoeOptions::station_alias>(
        "alias", {0, 0xFFFF},
        "Configured station alias (SII word 4); an EEPROM file in the state directory has "
        "precedence"),
    settings::word<&Tmcm3315Configuration::firmware>(
        "firmware", kFirmwareVersions,
        "1.07 has neither the N-channel latch 200Fh nor cyclic synchronous velocity"),
    settings::keys<product::kCoeKeys, &Tmcm3315Configuration::coe>(),
    settings::keys<product::kFirmwareDownloadKeys, &Tmcm3315Configuration::coe>(),
    settings::boolean<&Tmcm3315Configuration::home_offset_is_position>(
        "home_offset_is_position",
        "At home the position becomes the home offset 607Ch instead of its negative"),
    settings::sections<plant::kStepperAxisKeys, &Tmcm3315Configuration::axes>(
        "axis", "axes", "What is connected to an axis, axis 0 first"),
};

}  // namespace

}  // namespace tmcm_3315

constinit const settings::Section<Tmcm3315Configuration> kTmcm3315Keys{tmcm_3315::kModuleRows};

}  // namespace stator::devices
