#include "stator/devices/tmcc160/eds.hpp"

#include <array>
#include <string_view>

#include "stator/canopen/eds/eds.hpp"
#include "stator/devices/tmcc160/objects.hpp"

namespace stator::devices::tmcc160 {

namespace {
constexpr std::array<std::string_view, 3> kComments{
    "Made from the object dictionary of Stator's virtual TMCC160.",
    "The inhibit time of TPDOs (18xxh sub 3) counts milliseconds, not 100 us.",
    "Objects and their sources: docs/devices/tmcc160.md of Stator."};
}  // namespace

std::string eds(const dictionary::Dictionary& dictionary, bool lss) {
  return canopen::eds_text(dictionary,
                           {.file_name = "tmcc160.eds",
                            .title = "TMCC160, servo drive with CiA 402, firmware V3.00",
                            .time = "12:00AM",
                            .date = "08-29-2017",
                            .vendor_name = "TRINAMIC Motion Control GmbH & Co. KG",
                            .product_name = "TMCC160",
                            .order_code = "TMCC160",
                            .bit_rates = kBitRates,
                            .lss = lss,
                            .comments = kComments});
}

}  // namespace stator::devices::tmcc160
