#include "stator/devices/tmcc160/object_groups.hpp"

namespace stator::devices::tmcc160 {

namespace {

using dictionary::EntryDeclaration;
using dictionary::Range;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;
using enum dictionary::Access;

// Clears the flag.
constexpr std::array<std::int64_t, 1> kClearsFlag{0};

// Limit switches (2005h), home offset (2100h).
constexpr auto kSwitches = std::to_array<EntryDeclaration>({
    {.index = 0x2005,
     .name = "Limit switch parameters",
     .default_value = 0,
     .range = Range{0, 63},
     .unit = "bit field",
     .source = "L2245-L2246;L2682-L2683;L3371-L3372",
     .note = "REFERENCED ONLY: no object section in this document. Value 3 disables both limit "
             "switch inputs. Type from public EDS; default and range recommended. A-02"},
    {.index = 0x2100,
     .name = "Home offset display",
     .type = integer32,
     .access = read_only,
     .default_value = 0,
     .range = kAnyInteger32,
     .unit = "encoder or hall increments",
     .source = "L1326-L1342;L3079-L3095",
     .note = "A-66",
     .live = true},
});

// Status flags, supply voltage, temperature (200Dh to 200Fh).
constexpr auto kStatus = std::to_array<EntryDeclaration>({
    {.index = 0x200D,
     .name = "Status flags",
     .access = read_only,
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = "bit field",
     .source = "L982-L1030",
     .note = "Bits in bit_fields.csv. Printed default 0. A-34",
     .live = true},
    {.index = 0x200E,
     .name = "Supply voltage",
     .access = read_only,
     .default_value = 240,
     .range = Range{0, 1000},
     .unit = "100 mV",
     .source = "L1032-L1046",
     .note = "Live measurement; printed default 30.0 V. A-35",
     .live = true},
    {.index = 0x200F,
     .name = "Driver temperature",
     .type = integer32,
     .access = read_only,
     .default_value = 0,
     .range = Range{-20, 150},
     .unit = "degree C",
     .source = "L1048-L1064",
     .note = "Section title prints \"Driver Temperatur\". Live measurement.",
     .live = true},
});

// Hall sensors (2070h).
constexpr auto kHalls = std::to_array<EntryDeclaration>({
    highest_subindex(0x2070, record, 3, "Hall sensor settings: highest sub-index",
                     "Hall sensor settings", "L1245-L1261"),
    {.index = 0x2070,
     .subindex = 1,
     .name = "ActualAngle",
     .object_code = record,
     .type = integer16,
     .access = read_only,
     .default_value = 0,
     .range = Range{-32768, 32767},
     .unit = "65536 = 360 deg electrical",
     .source = "L1257",
     .note = "A-47. data type of the entry not printed (only \"Record\"); from value range and "
             "public EDS, A-43",
     .live = true},
    {.index = 0x2070,
     .subindex = 2,
     .name = "Inversion",
     .object_code = record,
     .type = unsigned8,
     .default_value = 0,
     .range = kSwitch,
     .source = "L1258",
     .note = kTypeNotPrinted},
    {.index = 0x2070,
     .subindex = 3,
     .name = "Interpolation",
     .object_code = record,
     .type = unsigned8,
     .default_value = 0,
     .range = kSwitch,
     .source = "L1259",
     .note = kTypeNotPrinted},
});

// ABN encoder (2080h).
constexpr auto kEncoder = std::to_array<EntryDeclaration>({
    highest_subindex(0x2080, record, 7, "ABN encoder settings: highest sub-index",
                     "ABN encoder settings", "L1262-L1284"),
    {.index = 0x2080,
     .subindex = 1,
     .name = "ActualAngle",
     .object_code = record,
     .type = integer16,
     .access = read_only,
     .default_value = 0,
     .range = Range{-32768, 32767},
     .unit = "65536 = 360 deg electrical",
     .source = "L1276",
     .note = "A-47. data type of the entry not printed (only \"Record\"); from value range and "
             "public EDS, A-43",
     .live = true},
    {.index = 0x2080,
     .subindex = 2,
     .name = "StepsPerRotation",
     .object_code = record,
     .type = unsigned16,
     .default_value = 4000,
     .range = kAnyUnsigned16,
     .unit = "steps/rev",
     .source = "L1277",
     .note = "same quantity as 608Fh:01. A-48. data type of the entry not printed (only "
             "\"Record\"); from value range and public EDS, A-43"},
    {.index = 0x2080,
     .subindex = 3,
     .name = "Offset",
     .object_code = record,
     .type = unsigned16,
     .default_value = 0,
     .range = kAnyUnsigned16,
     .unit = "encoder steps",
     .source = "L1278",
     .note = "A-45. data type of the entry not printed (only \"Record\"); from value range and "
             "public EDS, A-43"},
    {.index = 0x2080,
     .subindex = 4,
     .name = "Direction",
     .object_code = record,
     .type = unsigned8,
     .default_value = 0,
     .range = kSwitch,
     .source = "L1279",
     .note = kTypeNotPrinted},
    {.index = 0x2080,
     .subindex = 5,
     .name = "InitMode",
     .object_code = record,
     .type = unsigned8,
     .default_value = 1,
     .range = Range{0, 2},
     .unit = "enum",
     .source = "L1280",
     .note = "A-45. data type of the entry not printed (only \"Record\"); from value range and "
             "public EDS, A-43"},
    {.index = 0x2080,
     .subindex = 6,
     .name = "InitDelay",
     .object_code = record,
     .type = unsigned16,
     .default_value = 1000,
     .range = Range{0, 10000},
     .unit = "ms",
     .source = "L1281",
     .note = kTypeNotPrinted},
    {.index = 0x2080,
     .subindex = 7,
     .name = "InitVelocity",
     .object_code = record,
     .type = integer32,
     .default_value = 100,
     .range = kVelocityRange,
     .unit = "rpm",
     .source = "L1282",
     .note = "A-45. data type of the entry not printed (only \"Record\"); from value range and "
             "public EDS, A-43"},
});

// Brake chopper and I2t monitoring (2090h, 2095h).
constexpr auto kProtection = std::to_array<EntryDeclaration>({
    highest_subindex(0x2090, record, 3, "Brake chopper settings: highest sub-index",
                     "Brake chopper settings", "L1286-L1303"),
    {.index = 0x2090,
     .subindex = 1,
     .name = "EnableBrakeChopper",
     .object_code = record,
     .type = unsigned8,
     .default_value = 0,
     .range = kSwitch,
     .source = "L1299",
     .note = kTypeNotPrinted},
    {.index = 0x2090,
     .subindex = 2,
     .name = "BrakeChopperVoltageLimit",
     .object_code = record,
     .type = unsigned16,
     .default_value = 260,
     .range = Range{50, 480},
     .unit = "100 mV",
     .source = "L1300",
     .note = "26.0 V. data type of the entry not printed (only \"Record\"); from value range and "
             "public EDS, A-43"},
    {.index = 0x2090,
     .subindex = 3,
     .name = "BrakeChopperHysteresis",
     .object_code = record,
     .type = unsigned16,
     .default_value = 5,
     .range = Range{0, 50},
     .unit = "100 mV",
     .source = "L1301",
     .note = "0.5 V. data type of the entry not printed (only \"Record\"); from value range and "
             "public EDS, A-43"},
    highest_subindex(0x2095, record, 5, "IIT settings: highest sub-index", "IIT settings",
                     "L1304-L1324"),
    {.index = 0x2095,
     .subindex = 1,
     .name = "ThermalWindingTimeConstant",
     .object_code = record,
     .default_value = 30000,
     .range = Range{0, 300000},
     .unit = "ms",
     .source = "L1318",
     .note = kTypeNotPrinted},
    {.index = 0x2095,
     .subindex = 2,
     .name = "IItLimit",
     .object_code = record,
     .default_value = 5880000,
     .range = Range{0, 270000000},
     .unit = "A^2*ms",
     .source = "L1319",
     .note = "unit not printed, derived: 14 A * 14 A * 30000 ms. A-50. data type of the entry not "
             "printed (only \"Record\"); from value range and public EDS, A-43"},
    {.index = 0x2095,
     .subindex = 3,
     .name = "IItSum",
     .object_code = record,
     .access = read_only,
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = "A^2*ms",
     .source = "L1320",
     .note = "A-50. data type of the entry not printed (only \"Record\"); from value range and "
             "public EDS, A-43",
     .live = true},
    {.index = 0x2095,
     .subindex = 4,
     .name = "IItExceededCounter",
     .object_code = record,
     .default_value = 0,
     .range = kAnyUnsigned32,
     .source = "L1321",
     .note = "A-50. data type of the entry not printed (only \"Record\"); from value range and "
             "public EDS, A-43",
     .live = true},
    {.index = 0x2095,
     .subindex = 5,
     .name = "ClearIItExceededFlag",
     .object_code = record,
     .type = unsigned8,
     .access = write_only,
     .default_value = 0,
     .range = Range{0, 0},
     .source = "L1322",
     .note = "Printed range 0..0. A-51. data type of the entry not printed (only \"Record\"); from "
             "value range and public EDS, A-43",
     .legal_values = kClearsFlag},
});

}  // namespace

void add_sensor_objects(dictionary::Dictionary& dictionary) {
  dictionary.add(kSwitches);
  dictionary.add(kStatus);
  dictionary.add(kHalls);
  dictionary.add(kEncoder);
  dictionary.add(kProtection);
}

}  // namespace stator::devices::tmcc160
