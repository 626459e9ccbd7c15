// Manufacturer objects of a TMCM-3315 axis for its motion: resolution, currents, brake, switches,
// encoder, ramp, units.
#include "stator/devices/tmcm_3315/object_groups.hpp"

namespace stator::devices::tmcm_3315 {

namespace {

using dictionary::DriveCondition;
using dictionary::EntryDeclaration;
using dictionary::Range;
using dictionary::undocumented;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;
using enum dictionary::Access;

constexpr std::array<std::int64_t, 2> kVelocityDimensions{0, 181};

// Motor resolution (§4.2.1, §4.2.2, §4.2.61).
constexpr auto kResolution = std::to_array<EntryDeclaration>({
    {.index = 0x2000,
     .name = "Microstep resolution",
     .type = unsigned8,
     .default_value = 8,
     .range = Range{0, 8},
     .unit = "2^n microsteps/fullstep",
     .source = "L647-L660",
     .note = "8 = 256 microsteps per full step."},
    {.index = 0x2001,
     .name = "Motor full step resolution",
     .type = unsigned16,
     .default_value = 200,
     .range = kAnyUnsigned16,
     .unit = "fullsteps/rev",
     .source = "L662-L675",
     .note = "200 = 1.8 deg motor."},
    {.index = 0x2107,
     .name = "Microstep resolution display",
     .type = unsigned8,
     .access = read_only,
     .default_value = 8,
     .range = Range{0, 8},
     .unit = "2^n microsteps/fullstep",
     .source = "L1621-L1633",
     .note = "Mirror of 2000h."},
});

// Motor current (§4.2.4, §4.2.5, §4.2.35, §4.2.36).
constexpr auto kCurrent = std::to_array<EntryDeclaration>({
    {.index = 0x2003,
     .name = "Maximum current",
     .type = unsigned8,
     .default_value = 128,
     .range = kAnyUnsigned8,
     .unit = kCurrentUnit,
     .source = "L697-L710;L635",
     .note = "Run current. Quantised to 32 steps (value/8)."},
    {.index = 0x2004,
     .name = "Standby current",
     .type = unsigned8,
     .default_value = 8,
     .range = kAnyUnsigned8,
     .unit = kCurrentUnit,
     .source = "L711-L724;L636",
     .note = "Object table prints the name \"Maximum current\" (copy error)."},
    {.index = 0x204E,
     .name = "Boost current",
     .type = unsigned8,
     .default_value = undocumented(0),
     .range = kAnyUnsigned8,
     .unit = kCurrentUnit,
     .source = "L1182-L1194",
     .note = "Object table name \"Field weakening\" (copy error). 0 = use run current during "
             "ramps. Default not given (0 recommended)."},
    {.index = 0x2089,
     .name = "Setting delay (standby delay)",
     .type = unsigned16,
     .default_value = 200,
     .range = kAnyUnsigned16,
     .unit = "10 ms",
     .source = "L1196-L1210;L643",
     .note = "200 = 2 s."},
});

// Brake and drive enable timing (§4.2.3, §4.2.7, §4.2.9).
constexpr auto kBrake = std::to_array<EntryDeclaration>({
    inferred_highest_subindex(0x2002, array, 2, "Brake delay times", "L681-L695"),
    {.index = 0x2002,
     .subindex = 1,
     .name = "Brake delay: apply brake to disable power stage",
     .object_code = array,
     .type = unsigned16,
     .default_value = 0,
     .range = kAnyUnsigned16,
     .unit = "ms",
     .source = "L690"},
    {.index = 0x2002,
     .subindex = 2,
     .name = "Brake delay: release brake to Operation enabled",
     .object_code = array,
     .type = unsigned16,
     .default_value = 0,
     .range = kAnyUnsigned16,
     .unit = "ms",
     .source = "L691-L693"},
    {.index = 0x200A,
     .name = "Enable drive delay time",
     .type = unsigned16,
     .default_value = 0,
     .range = kAnyUnsigned16,
     .unit = "ms",
     .source = "L757-L770",
     .note = "Between enabling power stage and releasing brake."},
    inferred_highest_subindex(0x200C, array, 2, "Brake current feed", "L792-L804"),
    {.index = 0x200C,
     .subindex = 1,
     .name = "Brake apply current",
     .object_code = array,
     .type = unsigned8,
     .default_value = 0,
     .range = kAnyUnsigned8,
     .unit = "1/255 of max brake current",
     .source = "L801",
     .note = "Both subs 0 = automatic brake control off. Writable only in state SWITCH ON DISABLED "
             "(document spells it SWITCHED_ON_DISABLED), readable always.",
     .drive_condition = DriveCondition::switch_on_disabled},
    {.index = 0x200C,
     .subindex = 2,
     .name = "Brake release current",
     .object_code = array,
     .type = unsigned8,
     .default_value = 0,
     .range = kAnyUnsigned8,
     .unit = "1/255 of max brake current",
     .source = "L802",
     .note = "Both subs 0 = automatic brake control off. Writable only in state SWITCH ON DISABLED "
             "(document spells it SWITCHED_ON_DISABLED), readable always.",
     .drive_condition = DriveCondition::switch_on_disabled},
});

// Limit and home switches (§4.2.6).
constexpr auto kSwitches = std::to_array<EntryDeclaration>({
    {.index = 0x2005,
     .name = "Limit switches",
     .default_value = 0,
     .range = Range{0, 63},
     .unit = "bit field",
     .source = "L726-L755",
     .note = "Bits in bit_fields.csv. Writable only in state SWITCH ON DISABLED (document spells "
             "it SWITCHED_ON_DISABLED), readable always.",
     .drive_condition = DriveCondition::switch_on_disabled},
});

// Encoder (§4.2.8).
constexpr auto kEncoder = std::to_array<EntryDeclaration>({
    inferred_highest_subindex(0x200B, array, 3, "Encoder parameters", "L775-L787"),
    {.index = 0x200B,
     .subindex = 1,
     .name = "Encoder null channel polarity",
     .object_code = array,
     .type = unsigned8,
     .default_value = 0,
     .range = kSwitch,
     .source = "L783",
     .note = kOnlyInSwitchOnDisabled,
     .drive_condition = DriveCondition::switch_on_disabled},
    {.index = 0x200B,
     .subindex = 2,
     .name = "Encoder direction of rotation",
     .object_code = array,
     .type = unsigned8,
     .default_value = 0,
     .range = kSwitch,
     .source = "L784",
     .note = "1 = reversed relative to motor. Writable only in state SWITCH ON DISABLED (document "
             "spells it SWITCHED_ON_DISABLED), readable always.",
     .drive_condition = DriveCondition::switch_on_disabled},
    {.index = 0x200B,
     .subindex = 3,
     .name = "Initialize position with encoder position",
     .object_code = array,
     .type = unsigned8,
     .default_value = 1,
     .range = kSwitch,
     .source = "L785",
     .note = kOnlyInSwitchOnDisabled,
     .drive_condition = DriveCondition::switch_on_disabled},
});

// Latch of the encoder's N channel (§4.2.10).
constexpr auto kLatch = std::to_array<EntryDeclaration>({
    inferred_highest_subindex(0x200F, record, 3, "Encoder N channel latch", "L809-L821"),
    {.index = 0x200F,
     .subindex = 1,
     .name = "N channel latch mode",
     .object_code = record,
     .type = unsigned8,
     .default_value = 0,
     .range = kSwitch,
     .source = "L817",
     .note = "Data type not printed (UNSIGNED8 assumed). Write 1 to arm; self-clears to 0 on N "
             "event. Firmware 1.08+."},
    {.index = 0x200F,
     .subindex = 2,
     .name = "Latched internal position",
     .object_code = record,
     .type = integer32,
     .access = read_only,
     .default_value = 0,
     .range = kAnyInteger32,
     .unit = "microsteps",
     .source = "L818"},
    {.index = 0x200F,
     .subindex = 3,
     .name = "Latched encoder position",
     .object_code = record,
     .type = integer32,
     .access = read_only,
     .default_value = 0,
     .range = kAnyInteger32,
     .unit = "microsteps",
     .source = "L819",
     .note = "Unit not stated; see A-33."},
});

// Ramp generator beyond the profile objects (§4.2.11-4.2.16).
constexpr auto kRamp = std::to_array<EntryDeclaration>({
    {.index = 0x2010,
     .name = "Profile start velocity",
     .default_value = 0,
     .range = Range{0, 268435455},
     .unit = kVelocityUnit,
     .source = "L823-L836",
     .note = "VSTART of the six-point ramp."},
    {.index = 0x2011,
     .name = "Profile start acceleration (A1)",
     .default_value = 0,
     .range = kUnsigned24,
     .unit = kAccelerationUnit,
     .source = "L838-L851",
     .note = "VSTART to V1. Object table name \"Profile A1\"."},
    {.index = 0x2012,
     .name = "Profile break velocity (V1)",
     .default_value = 0,
     .range = kUnsigned24,
     .unit = kVelocityUnit,
     .source = "L852-L865",
     .note = "Object table name \"Profile V1\"."},
    {.index = 0x2013,
     .name = "Profile final deceleration (D1)",
     .default_value = 0,
     .range = kUnsigned24,
     .unit = kAccelerationUnit,
     .source = "L867-L880",
     .note =
         "Object table name \"Profile D1\". Text and name disagree about which segment; see A-20."},
    {.index = 0x2014,
     .name = "Profile stop deceleration",
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = kAccelerationUnit,
     .source = "L882-L894",
     .note = "End velocity to zero. See A-21."},
    {.index = 0x2015,
     .name = "Bow scaling factor",
     .type = unsigned8,
     .default_value = 1,
     .range = Range{1, 255},
     .unit = "factor",
     .source = "L896-L909",
     .note = "Object table name \"Ramp Wait Time\" (copy error). bow*factor must not exceed "
             "467.837e9 as printed (476.837e9 computed); see A-22."},
});

// Units of velocity and acceleration (§4.2.37, §4.2.38).
constexpr auto kUnits = std::to_array<EntryDeclaration>({
    {.index = 0x208C,
     .name = "Velocity dimension index",
     .type = unsigned8,
     .default_value = 181,
     .range = Range{0, 181},
     .unit = "enum 0/181",
     .source = "L1212-L1229",
     .note = "Only 0 (internal) and 181 (pps, pps/s) are legal. Writable only in state SWITCH ON "
             "DISABLED (document spells it SWITCHED_ON_DISABLED), readable always.",
     .legal_values = kVelocityDimensions,
     .drive_condition = DriveCondition::switch_on_disabled},
    {.index = 0x208E,
     .name = "Acceleration dimension index",
     .type = unsigned8,
     .access = read_only,
     .default_value = 179,
     .range = Range{0, 179},
     .unit = "enum 0/179",
     .source = "L1231-L1244",
     .note = "Follows 208Ch: 0 -> 0, 181 -> 179."},
});

// What the axis measures (§4.2.58-4.2.60, §4.2.62).
constexpr auto kMonitoring = std::to_array<EntryDeclaration>({
    {.index = 0x2100,
     .name = "Home offset display",
     .type = integer32,
     .access = read_only,
     .default_value = 0,
     .range = kAnyInteger32,
     .unit = "microsteps",
     .source = "L1564-L1577"},
    {.index = 0x2101,
     .name = "Actual load value",
     .type = unsigned16,
     .access = read_only,
     .default_value = 0,
     .range = Range{0, 1023},
     .unit = "StallGuard2 counts",
     .source = "L1579-L1591"},
    {.index = 0x2102,
     .name = "Driver error flags",
     .type = unsigned8,
     .access = read_only,
     .default_value = 0,
     .range = kAnyUnsigned8,
     .unit = "bit field",
     .source = "L1593-L1619",
     .note = "Bits in bit_fields.csv."},
    inferred_highest_subindex(0x210B, record, 3, "Step counter", "L1638-L1651"),
    {.index = 0x210B,
     .subindex = 1,
     .name = "Step counter lower 32 bits",
     .object_code = record,
     .access = read_only,
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = "microsteps",
     .source = "L1647",
     .note = "Data type not printed; range gives 32 bit."},
    {.index = 0x210B,
     .subindex = 2,
     .name = "Step counter higher 32 bits",
     .object_code = record,
     .access = read_only,
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = "microsteps",
     .source = "L1648",
     .note = "Data type not printed; range gives 32 bit."},
    {.index = 0x210B,
     .subindex = 3,
     .name = "Step counter 64 bit value",
     .object_code = record,
     .type = unsigned64,
     .access = read_only,
     .default_value = 0,
     .range = Range{0, 18446744073709551615U},
     .unit = "microsteps",
     .source = "L1649",
     .note = "8 bytes, so SDO upload is not expedited."},
});

}  // namespace

void add_axis_motion_objects(dictionary::Dictionary& dictionary,
                             const dictionary::Placement& placement, FirmwareVersion firmware) {
  dictionary.add(kResolution, placement);
  dictionary.add(kCurrent, placement);
  dictionary.add(kBrake, placement);
  dictionary.add(kSwitches, placement);
  dictionary.add(kEncoder, placement);
  if (firmware >= FirmwareVersion::v1_08) {
    dictionary.add(kLatch, placement);
  }
  dictionary.add(kRamp, placement);
  dictionary.add(kUnits, placement);
  dictionary.add(kMonitoring, placement);
}

}  // namespace stator::devices::tmcm_3315
