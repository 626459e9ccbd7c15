// Objects of CiA 402 on a TMCM-3315 axis: power state machine, modes, sensor, homing, torque,
// inputs.
#include "stator/devices/tmcm_3315/object_groups.hpp"

namespace stator::devices::tmcm_3315 {

namespace {

using dictionary::EntryDeclaration;
using dictionary::hex;
using dictionary::Range;
using dictionary::undocumented;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;
using enum dictionary::Access;
using enum dictionary::PdoMapping;

constexpr std::array<std::int64_t, 1> kOnlyZero{0};
constexpr std::array<std::int64_t, 1> kOnlyOne{1};
constexpr std::array<std::int64_t, 1> kOnlyTwo{2};
constexpr std::array<std::int64_t, 4> kQuickStopOptions{1, 2, 5, 6};
constexpr std::array<std::int64_t, 7> kLegalModes{0, 1, 3, 6, 8, 9, 10};
constexpr std::array<std::int64_t, 6> kLegalModesWithoutCsv{0, 1, 3, 6, 8, 10};
constexpr std::array<std::int64_t, 2> kSensorSelections{-1, 0};
constexpr std::array<std::int64_t, 12> kHomingMethods{0, 1, 2, 3, 5, 17, 18, 19, 21, 33, 34, 35};

// Power drive state machine and its option codes (§5.1.1-5.1.5, §6.1.1, §6.1.2).
constexpr auto kPowerStateMachine = std::to_array<EntryDeclaration>({
    {.index = 0x6040,
     .name = "Controlword",
     .type = unsigned16,
     .mapping = receive,
     .default_value = 0,
     .range = kAnyUnsigned16,
     .unit = "bit field",
     .source = "L2062-L2107;L2471-L2508;L2938-L2981;L3135-L3171;L3359-L3395;L3538-L3574",
     .note = "Document refers to CiA 402-3 for PDO mapping. Default not printed; 0 assumed."},
    {.index = 0x6041,
     .name = "Statusword",
     .type = unsigned16,
     .access = read_only,
     .mapping = transmit,
     .default_value = undocumented(0),
     .range = kAnyUnsigned16,
     .unit = "bit field",
     .source = "L2109-L2157;L2510-L2565;L2983-L3031;L3173-L3223;L3397-L3446;L3576-L3626",
     .note = "Document refers to CiA 402-3 for PDO mapping. Tables print name \"Controlword\" and "
             "access rw (copy errors); CiA 402 access is ro."},
    {.index = 0x605A,
     .name = "Quick stop option code",
     .type = integer16,
     .default_value = 2,
     .range = Range{1, 6},
     .unit = "enum 1/2/5/6",
     .source = "L1754-L1775",
     .note = "Only 1, 2, 5, 6 are legal.",
     .legal_values = kQuickStopOptions},
    {.index = 0x605B,
     .name = "Shutdown option code",
     .type = unsigned16,
     .default_value = 0,
     .range = Range{0, 0},
     .unit = "enum",
     .source = "L1777-L1796",
     .note = "Only 0. Printed UNSIGNED16 (CiA 402: INTEGER16).",
     .legal_values = kOnlyZero},
    {.index = 0x605C,
     .name = "Disable operation option code",
     .type = unsigned16,
     .default_value = 1,
     .range = Range{1, 1},
     .unit = "enum",
     .source = "L1798-L1818",
     .note = "Only 1. Printed UNSIGNED16 (CiA 402: INTEGER16).",
     .legal_values = kOnlyOne},
    {.index = 0x605D,
     .name = "Halt option code",
     .type = unsigned16,
     .default_value = 1,
     .range = Range{1, 1},
     .unit = "enum",
     .source = "L1820-L1838",
     .note = "Only 1. Printed UNSIGNED16 (CiA 402: INTEGER16).",
     .legal_values = kOnlyOne},
    {.index = 0x605E,
     .name = "Fault reaction option code",
     .type = unsigned16,
     .default_value = 2,
     .range = Range{2, 2},
     .unit = "enum",
     .source = "L1840-L1859",
     .note = "Only 2. Printed UNSIGNED16 (CiA 402: INTEGER16).",
     .legal_values = kOnlyTwo},
});

// Modes of operation (§5.1.6, §5.1.7, §5.1.11).
constexpr auto kModes = std::to_array<EntryDeclaration>({
    {.index = 0x6060,
     .name = "Modes of operation",
     .type = integer8,
     .mapping = receive,
     .default_value = 0,
     .range = Range{0, 10},
     .unit = "enum 0/1/3/6/8/9/10",
     .source = "L1861-L1887",
     .note = "Document refers to CiA 402-3 for PDO mapping.",
     .legal_values = kLegalModes},
    {.index = 0x6061,
     .name = "Modes of operation display",
     .type = integer8,
     .access = read_only,
     .mapping = transmit,
     .default_value = 0,
     .range = Range{0, 10},
     .unit = "enum 0/1/3/6/8/9/10",
     .source = "L1889-L1915",
     .note = "Document refers to CiA 402-3 for PDO mapping. Printed rw; ro per CiA 402."},
    {.index = 0x6502,
     .name = "Supported drive modes",
     .access = read_only,
     .default_value = hex(0x000003A5),
     .range = kAnyUnsigned32,
     .unit = "bit field",
     .source = "L1975-L2002",
     .note = "Document: depends on supported modes. 3A5h computed here = pp|pv|hm|csp|csv|cst."},
});

/// Of firmware 1.07.
constexpr auto kModesWithoutCsv = [] {
  auto rows = kModes;
  for (EntryDeclaration& row : rows) {
    if (row.index == 0x6060) {
      row.legal_values = kLegalModesWithoutCsv;
    } else if (row.index == 0x6502) {
      row.default_value = hex(0x000002A5);
    }
  }
  return rows;
}();

// Position sensor (§5.1.8, §5.1.9).
constexpr auto kSensor = std::to_array<EntryDeclaration>({
    {.index = 0x606A,
     .name = "Sensor selection code",
     .type = integer16,
     .default_value = -1,
     .range = Range{-1, 0},
     .unit = "enum",
     .source = "L1917-L1936",
     .note = "0 = encoder, -1 = no encoder.",
     .legal_values = kSensorSelections},
    {.index = 0x608F,
     .name = "Highest sub-index supported",
     .object_code = array,
     .type = unsigned8,
     .access = read_only,
     .default_value = 2,
     .range = Range{2, 2},
     .source = "L1955",
     .object_name = "Position encoder resolution"},
    {.index = 0x608F,
     .subindex = 1,
     .name = "Encoder increments",
     .object_code = array,
     .default_value = 1,
     .range = kUnsigned31,
     .unit = "increments",
     .source = "L1956;L121",
     .note = "Example disagrees on lines vs counts; see A-16."},
    {.index = 0x608F,
     .subindex = 2,
     .name = "Motor revolutions",
     .object_code = array,
     .access = read_only,
     .default_value = 1,
     .range = Range{1, 1},
     .unit = "revolutions",
     .source = "L1957"},
});

// Homing (§8.2.4-8.2.7).
constexpr auto kHoming = std::to_array<EntryDeclaration>({
    {.index = 0x607C,
     .name = "Home offset",
     .type = integer32,
     .default_value = 0,
     .range = kAnyInteger32,
     .unit = "microsteps",
     .source = "L3047-L3066"},
    {.index = 0x6098,
     .name = "Homing method",
     .type = integer8,
     .default_value = 0,
     .range = kAnyInteger8,
     .unit = "enum",
     .source = "L3067-L3080",
     .note = "Legal: 0,1,2,3,5,17,18,19,21,33,34,35 (homing_methods.csv).",
     .legal_values = kHomingMethods},
    inferred_highest_subindex(0x6099, array, 2, "Homing speeds", "L3085-L3097"),
    {.index = 0x6099,
     .subindex = 1,
     .name = "Fast homing speed",
     .object_code = array,
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = kVelocityUnit,
     .source = "L3094"},
    {.index = 0x6099,
     .subindex = 2,
     .name = "Slow homing speed",
     .object_code = array,
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = kVelocityUnit,
     .source = "L3095"},
    {.index = 0x609A,
     .name = "Homing acceleration",
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = kAccelerationUnit,
     .source = "L3099-L3111",
     .note = "Acceleration and deceleration during homing."},
});

// Torque, in mA (chapter 11).
constexpr auto kTorque = std::to_array<EntryDeclaration>({
    {.index = 0x6071,
     .name = "Target torque",
     .type = integer16,
     .mapping = receive,
     .default_value = 0,
     .range = kAnyInteger16,
     .unit = "mA",
     .source = "L3671-L3684",
     .note = "Document says PDO \"yes\". CiA 402 unit would be 1/1000 of rated torque."},
    {.index = 0x6077,
     .name = "Torque actual value",
     .type = integer16,
     .access = read_only,
     .mapping = transmit,
     .default_value = 0,
     .range = kAnyInteger16,
     .unit = "mA",
     .source = "L3686-L3699",
     .note = "Document says PDO \"yes\"."},
    {.index = 0x60B2,
     .name = "Torque offset",
     .type = integer16,
     .mapping = receive,
     .default_value = 0,
     .range = kAnyInteger16,
     .unit = "mA",
     .source = "L3722-L3735",
     .note = "Added to 6071h in cst. Unit taken from 6071h."},
});

// Digital inputs of the axis (§5.1.10).
constexpr auto kInputs = std::to_array<EntryDeclaration>({
    {.index = 0x60FD,
     .name = "Digital inputs",
     .access = read_only,
     .mapping = transmit,
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = "bit field",
     .source = "L1961-L1973",
     .note = "Printed rw; ro per CiA 402. Bit allocation not given; see A-35."},
});

}  // namespace

void add_profile_drive_objects(dictionary::Dictionary& dictionary,
                               const dictionary::Placement& placement, FirmwareVersion firmware) {
  dictionary.add(kPowerStateMachine, placement);
  if (firmware >= FirmwareVersion::v1_08) {
    dictionary.add(kModes, placement);
  } else {
    dictionary.add(kModesWithoutCsv, placement);
  }
  dictionary.add(kSensor, placement);
  dictionary.add(kHoming, placement);
  dictionary.add(kTorque, placement);
  dictionary.add(kInputs, placement);
}

}  // namespace stator::devices::tmcm_3315
