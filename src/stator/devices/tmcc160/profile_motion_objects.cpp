#include "stator/devices/tmcc160/object_groups.hpp"

namespace stator::devices::tmcc160 {

namespace {

using dictionary::EntryDeclaration;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;
using enum dictionary::Access;
using enum dictionary::PdoMapping;

// Positions of the controller (6062h, 6063h).
constexpr auto kControllerPosition = std::to_array<EntryDeclaration>({
    {.index = 0x6062,
     .name = "Position demand value",
     .type = integer32,
     .access = read_only,
     .default_value = 0,
     .range = kAnyInteger32,
     .unit = "hall or encoder steps",
     .source = "L2013-L2038;L2436-L2451",
     .note = "Public EDS: mappable. A-25",
     .live = true},
    {.index = 0x6063,
     .name = "Position actual internal value",
     .type = integer32,
     .access = read_only,
     .default_value = 0,
     .range = kAnyInteger32,
     .unit = "hall or encoder steps",
     .source = "L2039-L2048;L2452-L2463",
     .note = "Public EDS: mappable. A-25",
     .live = true},
});
constexpr auto kMappableControllerPosition = mappable(kControllerPosition);

// Positions and their window (6064h to 6067h, 607Ah, 607Dh).
constexpr auto kPosition = std::to_array<EntryDeclaration>({
    {.index = 0x6064,
     .name = "Position actual value",
     .type = integer32,
     .access = read_only,
     .mapping = transmit,
     .default_value = 0,
     .range = kAnyInteger32,
     .unit = "hall or encoder steps",
     .source = "L2050-L2067;L2464-L2481",
     .note =
         "Always equal to 6063h. Printed pdo=no although TPDO 3 maps it by default (L960). A-25",
     .live = true},
    {.index = 0x6067,
     .name = "Position window",
     .default_value = 4294967295,
     .range = kAnyUnsigned32,
     .unit = "increments",
     .source = "L2068-L2088",
     .note = "FFFFFFFFh = control off; 0 = demand reached target. A-59"},
    {.index = 0x607A,
     .name = "Target position",
     .type = integer32,
     .mapping = receive,
     .default_value = 0,
     .range = kAnyInteger32,
     .unit = "hall or encoder steps",
     .source = "L2102-L2117",
     .note = "Printed pdo=no although RPDO 3 maps it by default (L867). A-25"},
    highest_subindex(0x607D, array, 2, "Software position limit: highest sub-index",
                     "Software position limit", "L2119-L2141;L2501-L2524"),
    {.index = 0x607D,
     .subindex = 1,
     .name = "Min position limit",
     .object_code = array,
     .type = integer32,
     .default_value = -2147483648,
     .range = kAnyInteger32,
     .unit = "hall or encoder steps",
     .source = "L2138;L2521",
     .note = "Overwritten by homing -2, -3, -4, -5, -6"},
    {.index = 0x607D,
     .subindex = 2,
     .name = "Max position limit",
     .object_code = array,
     .type = integer32,
     .default_value = 2147483647,
     .range = kAnyInteger32,
     .unit = "hall or encoder steps",
     .source = "L2139;L2522",
     .note = "Overwritten by homing -1, -3, -4, -5, -6"},
});

// Velocities and ramps (606Ch, 6081h to 6085h, 60FFh).
constexpr auto kVelocity = std::to_array<EntryDeclaration>({
    {.index = 0x606C,
     .name = "Velocity actual value",
     .type = integer32,
     .access = read_only,
     .mapping = transmit,
     .default_value = 0,
     .range = kAnyInteger32,
     .unit = "rpm",
     .source = "L2089-L2100;L2483-L2499;L2975-L2988",
     .note = "Printed pdo=no although TPDO 4 maps it by default (L961). A-25",
     .live = true},
    {.index = 0x6081,
     .name = "Profile velocity",
     .default_value = 0,
     .range = kSpeedRange,
     .unit = "rpm",
     .source = "L2143-L2160",
     .note = "Public EDS 3.14 default 4000, mappable. A-60"},
    {.index = 0x6082,
     .name = "End velocity",
     .type = integer32,
     .default_value = 0,
     .range = kVelocityRange,
     .unit = "rpm",
     .source = "L2162-L2182",
     .note = "A-61"},
    {.index = 0x6083,
     .name = "Profile acceleration",
     .default_value = 2000,
     .range = kAccelerationRange,
     .unit = "rpm/s",
     .source = "L2184-L2201;L2526-L2544",
     .note = "pp and pv"},
    {.index = 0x6084,
     .name = "Profile deceleration",
     .default_value = 2000,
     .range = kAccelerationRange,
     .unit = "rpm/s",
     .source = "L2203-L2219",
     .note = "Public EDS: ro. A-60"},
    {.index = 0x6085,
     .name = "Quick stop deceleration",
     .default_value = 2000,
     .range = kAccelerationRange,
     .unit = "rpm/s",
     .source = "L2221-L2238;L2546-L2563",
     .note = "Used for 605Ah = 2 or 6 and for fault reaction"},
    {.index = 0x60FF,
     .name = "Target velocity",
     .type = integer32,
     .mapping = receive,
     .default_value = 0,
     .range = kVelocityRange,
     .unit = "rpm",
     .source = "L2565-L2581",
     .note = "Default lost in extraction; 0 assumed. Printed pdo=no although RPDO 4 maps it by "
             "default (L868). A-25"},
});

}  // namespace

void add_profile_motion_objects(dictionary::Dictionary& dictionary, const Options& options) {
  dictionary.add(options.maps_as_maker_eds ? kMappableControllerPosition : kControllerPosition);
  dictionary.add(kPosition);
  dictionary.add(kVelocity);
}

}  // namespace stator::devices::tmcc160
