#include "stator/product/shell/coe_keys.hpp"

#include <array>

namespace stator::product {

namespace {

using namespace base::literals;

constexpr std::array kCoeRows{
    settings::boolean<&CoeOptions::emergencies>(
        "emergencies",
        "false: no CoE emergencies, for masters that cannot take an unsolicited message"),
    settings::boolean<&CoeOptions::require_outputs>(
        "require_outputs",
        "Operational is refused with AL status 0019h until outputs have come in Safe-Operational"),
    settings::whole<&CoeOptions::identification>(
        "identification", {0, 0xFFFF},
        "Explicit device identification: what an ID switch would show"),
};

constexpr std::array kFirmwareDownloadRows{
    settings::duration<&CoeOptions::firmware_erase_time>(
        "firmware_erase_time", {0_us, 60_s},
        "How long a firmware download is answered busy while the flash is erased"),
};

}  // namespace

constinit const settings::Section<CoeOptions> kCoeKeys{kCoeRows};
constinit const settings::Section<CoeOptions> kFirmwareDownloadKeys{kFirmwareDownloadRows};

}  // namespace stator::product
