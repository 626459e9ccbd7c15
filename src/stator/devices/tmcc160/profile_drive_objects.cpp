#include "stator/devices/tmcc160/object_groups.hpp"

namespace stator::devices::tmcc160 {

namespace {

using dictionary::EntryDeclaration;
using dictionary::Range;
using dictionary::undocumented;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;
using enum dictionary::Access;
using enum dictionary::PdoMapping;

// Quick stop option codes.
constexpr std::array<std::int64_t, 4> kQuickStopCodes{1, 2, 5, 6};
// No mode, pp, pv, hm, cst.
constexpr std::array<std::int64_t, 5> kModesOfOperation{0, 1, 3, 6, 10};
// Homing methods.
constexpr std::array<std::int64_t, 10> kHomingMethods{-6, -5, -4, -3, -2, -1, 0, 17, 18, 35};

// Power drive state machine (6040h, 6041h, 605Ah to 605Eh).
constexpr auto kStateMachine = std::to_array<EntryDeclaration>({
    {.index = 0x6040,
     .name = "Controlword",
     .type = unsigned16,
     .mapping = receive,
     .default_value = undocumented(0),
     .range = kAnyUnsigned16,
     .unit = "bit field",
     .source = "L1838-L1897;L2277-L2324;L2797-L2863;L3130-L3177",
     .note = "Printed mapping: see CiA402-3. Default not printed; 0 recommended."},
    {.index = 0x6041,
     .name = "Statusword",
     .type = unsigned16,
     .access = read_only,
     .mapping = transmit,
     .default_value = undocumented(0),
     .range = kAnyUnsigned16,
     .unit = "bit field",
     .source = "L1899-L2011;L2326-L2434;L2865-L2973;L3179-L3303",
     .note = "Printed name Controlword and access rw are copy errors. Printed mapping: see "
             "CiA402-3. A-55",
     .live = true},
    {.index = 0x605A,
     .name = "Quick stop option code",
     .type = integer16,
     .default_value = 2,
     .range = Range{1, 6},
     .unit = "enum",
     .source = "L1515-L1538",
     .note = "Codes 1 2 5 6. Printed default 0 lies outside the range; public EDS 2. A-52",
     .legal_values = kQuickStopCodes},
    {.index = 0x605B,
     .name = "Shutdown option code",
     .type = integer16,
     .default_value = 0,
     .range = Range{0, 0},
     .unit = "enum",
     .source = "L1540-L1559",
     .note = "Only 0"},
    {.index = 0x605C,
     .name = "Disable operation option code",
     .type = integer16,
     .default_value = 1,
     .range = Range{1, 1},
     .unit = "enum",
     .source = "L1561-L1580",
     .note = "Only 1"},
    {.index = 0x605D,
     .name = "Halt option code",
     .type = integer16,
     .default_value = 1,
     .range = Range{1, 1},
     .unit = "enum",
     .source = "L1582-L1602",
     .note = "Only 1"},
    {.index = 0x605E,
     .name = "Fault reaction option code",
     .type = integer16,
     .default_value = 2,
     .range = Range{2, 2},
     .unit = "enum",
     .source = "L1604-L1623",
     .note = "Only 2"},
});

// Modes of operation (6060h, 6061h, 6502h).
constexpr auto kModes = std::to_array<EntryDeclaration>({
    {.index = 0x6060,
     .name = "Modes of operation",
     .type = integer8,
     .mapping = receive,
     .default_value = 0,
     .range = Range{0, 10},
     .unit = "enum",
     .source = "L1625-L1652",
     .note = "Codes 0 1 3 6 10. Printed pdo=no although RPDO 2 maps it by default (L866). A-25",
     .legal_values = kModesOfOperation},
    {.index = 0x6061,
     .name = "Modes of operation display",
     .type = integer8,
     .access = read_only,
     .mapping = transmit,
     .default_value = 0,
     .range = Range{0, 10},
     .unit = "enum",
     .source = "L1654-L1677",
     .note = "Printed pdo=no although TPDO 2 maps it by default (L959). A-25",
     .live = true},
    {.index = 0x6502,
     .name = "Supported drive modes",
     .access = read_only,
     .default_value = 549,
     .range = kAnyUnsigned32,
     .unit = "bit field",
     .source = "L1740-L1774",
     .note = "Printed default 0; value for pp+pv+hm+cst is 225h (public EDS). A-54"},
});

// Cyclic synchronous torque mode (6071h, 6077h, 60B2h).
constexpr auto kTorque = std::to_array<EntryDeclaration>({
    {.index = 0x6071,
     .name = "Target torque",
     .type = integer32,
     .default_value = 0,
     .range = kCurrentRange,
     .unit = "mA",
     .source = "L3305-L3320",
     .note = "SIGNED32 in mA; CiA 402 has INTEGER16 per mille. Unit printed \"[MmA]\" (OCR). A-72"},
    {.index = 0x6077,
     .name = "Torque actual value",
     .type = integer32,
     .access = read_only,
     .default_value = 0,
     .range = kAnyInteger32,
     .unit = "mA",
     .source = "L3322-L3338",
     .note = "Unit not printed; \"actual motor current\"",
     .live = true},
    {.index = 0x60B2,
     .name = "Torque offset",
     .type = integer32,
     .default_value = 0,
     .range = kAnyInteger32,
     .unit = "mA",
     .source = "L3340-L3355",
     .note = "Unit not printed. A-72"},
});

// Homing mode (607Ch, 6098h to 609Ah).
constexpr auto kHoming = std::to_array<EntryDeclaration>({
    {.index = 0x607C,
     .name = "Home offset",
     .type = integer32,
     .default_value = 0,
     .range = kAnyInteger32,
     .unit = "hall or encoder steps",
     .source = "L2990-L3008",
     .note = "A-65"},
    {.index = 0x6098,
     .name = "Homing method",
     .type = integer8,
     .default_value = 0,
     .range = Range{0, 35},
     .unit = "enum",
     .source = "L3010-L3038;L2655-L2680",
     .note = "Printed range excludes the supported methods -1..-6. Effective range -6..35. A-68",
     .legal_values = kHomingMethods},
    highest_subindex(0x6099, array, 2, "Homing speeds: highest sub-index", "Homing speeds",
                     "L1699-L1718;L3040-L3060"),
    {.index = 0x6099,
     .subindex = 1,
     .name = "Fast homing speed",
     .object_code = array,
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = "rpm",
     .source = "L1715;L3057",
     .note = "Unit not printed. A-69"},
    {.index = 0x6099,
     .subindex = 2,
     .name = "Slow homing speed",
     .object_code = array,
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = "rpm",
     .source = "L1716;L3058",
     .note = "Unit not printed. A-69"},
    {.index = 0x609A,
     .name = "Homing acceleration",
     .default_value = 2000,
     .range = kAccelerationRange,
     .unit = "rpm/s",
     .source = "L3062-L3077"},
});

// Encoder resolution and digital inputs (608Fh, 60FDh).
constexpr auto kInputs = std::to_array<EntryDeclaration>({
    highest_subindex(0x608F, array, 2, "Position encoder resolution: highest sub-index",
                     "Position encoder resolution", "L1679-L1697"),
    {.index = 0x608F,
     .subindex = 1,
     .name = "Encoder increments",
     .object_code = array,
     .default_value = 4000,
     .range = kAnyUnsigned16,
     .unit = "increments",
     .source = "L1694",
     .note = "A-48"},
    {.index = 0x608F,
     .subindex = 2,
     .name = "Motor revolutions",
     .object_code = array,
     .access = read_only,
     .default_value = 1,
     .range = Range{1, 1},
     .unit = "revolutions",
     .source = "L1695"},
});

constexpr auto kLimitSwitches = std::to_array<EntryDeclaration>({
    {.index = 0x60FD,
     .name = "Digital inputs",
     .access = read_only,
     .default_value = 0,
     .range = Range{0, 3},
     .unit = "bit field",
     .source = "L1720-L1738",
     .note = "Entry named Limit Switches. Public EDS: mappable. A-32",
     .live = true},
});
constexpr auto kMappableLimitSwitches = mappable(kLimitSwitches);

}  // namespace

void add_profile_drive_objects(dictionary::Dictionary& dictionary, const Options& options) {
  dictionary.add(kStateMachine);
  dictionary.add(kModes);
  dictionary.add(kTorque);
  dictionary.add(kHoming);
  dictionary.add(kInputs);
  dictionary.add(options.maps_as_maker_eds ? kMappableLimitSwitches : kLimitSwitches);
}

}  // namespace stator::devices::tmcc160
