// Communication objects of a TMCM-3315 (§3.1): identification, PDO mapping, sync managers.
#include "stator/devices/tmcm_3315/object_groups.hpp"

namespace stator::devices::tmcm_3315 {

namespace {

using dictionary::EntryDeclaration;
using dictionary::hex;
using dictionary::Range;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;
using enum dictionary::Access;

constexpr EntryDeclaration mapping_entry(std::uint16_t index, std::uint8_t subindex,
                                         std::string_view name, std::uint32_t mapped,
                                         std::string_view source, std::string_view note = {}) {
  return {.index = index,
          .subindex = subindex,
          .name = name,
          .object_code = record,
          .default_value = hex(mapped),
          .range = kAnyUnsigned32,
          .unit = "index<<16|sub<<8|bits",
          .source = source,
          .note = note,
          .write_states = dictionary::kPreOperationalOnly};
}

// 1C00h is printed as writable and called "normally fixed": each entry takes the value it has.
constexpr std::array<std::int64_t, 1> kSyncManagerCount{4};
constexpr std::array<std::int64_t, 1> kSyncManagerType1{1};
constexpr std::array<std::int64_t, 1> kSyncManagerType2{2};
constexpr std::array<std::int64_t, 1> kSyncManagerType3{3};
constexpr std::array<std::int64_t, 1> kSyncManagerType4{4};

// Device type, error register, names and identity (§3.1.1-3.1.6).
constexpr auto kIdentification = std::to_array<EntryDeclaration>({
    {.index = 0x1000,
     .name = "Device type",
     .access = read_only,
     .default_value = hex(0xFFFC0192),
     .range = kAnyUnsigned32,
     .source = "L389-L402",
     .note = "Low word 0192h = 402 (device profile); high word FFFCh taken literally. See "
             "ambiguities A-09."},
    {.index = 0x1001,
     .name = "Error register",
     .type = unsigned8,
     .access = read_only,
     .default_value = 0,
     .range = kAnyUnsigned8,
     .unit = "bit field",
     .source = "L404-L429",
     .note = "Bits in bit_fields.csv; copied into every emergency message. Bit 6 always 0."},
    {.index = 0x1008,
     .name = "Manufacturer device name",
     .type = visible_string,
     .access = read_only,
     .default_value = "TMCM-3315",
     .source = "L431-L444",
     .note = "9 characters, so SDO upload cannot be expedited."},
    {.index = 0x1009,
     .name = "Manufacturer hardware version",
     .type = visible_string,
     .access = read_only,
     .default_value = "2.0",
     .source = "L446-L458;L3809",
     .note = "Document: depends on device, e.g. \"1.0\". \"2.0\" chosen here because the firmware "
             "history ties V1.07+ to hardware V2.0."},
    {.index = 0x100A,
     .name = "Manufacturer software version",
     .type = visible_string,
     .access = read_only,
     .default_value = "1.09",
     .source = "L460-L473;L3811",
     .note = "Document: depends on device, e.g. \"1.0\". \"1.09\" = firmware version documented by "
             "this manual."},
    {.index = 0x1018,
     .name = "Number of entries",
     .object_code = record,
     .type = unsigned8,
     .access = read_only,
     .default_value = 3,
     .range = Range{0, 3},
     .source = "L490",
     .note = "Range printed as 0..3. CoE normally demands 4 (serial number); see A-10.",
     .object_name = "Identity object"},
    {.index = 0x1018,
     .subindex = 1,
     .name = "Vendor ID",
     .object_code = record,
     .access = read_only,
     .default_value = hex(0x00000286),
     .range = kAnyUnsigned32,
     .source = "L478;L491",
     .note = "Trinamic EtherCAT vendor ID."},
    {.index = 0x1018,
     .subindex = 2,
     .name = "Product code",
     .object_code = record,
     .access = read_only,
     .default_value = 3315,
     .range = kAnyUnsigned32,
     .source = "L479;L492",
     .note = "Printed without h suffix, so decimal 3315 = 0CF3h. See A-11."},
    {.index = 0x1018,
     .subindex = 3,
     .name = "Revision number",
     .object_code = record,
     .access = read_only,
     .default_value = hex(0x00010009),
     .range = kAnyUnsigned32,
     .source = "L480;L493",
     .note = "High word = major, low word = minor; document example 20003h = version 2.3. "
             "00010009h computed here for firmware V1.09."},
});

/// The same with another firmware.
constexpr auto identification_of(FirmwareVersion firmware, const char* version) {
  auto rows = kIdentification;
  for (EntryDeclaration& row : rows) {
    if (row.index == 0x100A) {
      row.default_value = version;
    } else if (row.index == 0x1018 && row.subindex == 3) {
      row.default_value = hex(revision_of(firmware));
    }
  }
  return rows;
}
constexpr auto kIdentification107 = identification_of(FirmwareVersion::v1_07, "1.07");
constexpr auto kIdentification108 = identification_of(FirmwareVersion::v1_08, "1.08");

// What the one RPDO and the one TPDO carry (§3.1.7, §3.1.8).
constexpr auto kPdoMapping = std::to_array<EntryDeclaration>({
    {.index = 0x1600,
     .name = "Number of mapped application objects in RPDO",
     .object_code = record,
     .type = unsigned8,
     .default_value = 9,
     .range = Range{0, 9},
     .source = "L509-L511",
     .note = "Write 0 before changing sub 01..09 (CiA 301 procedure; not stated here).",
     .object_name = "Receive PDO mapping parameter",
     .write_states = dictionary::kPreOperationalOnly},
    mapping_entry(0x1600, 1, "RPDO mapping entry 1", 0x60400010, "L513"),
    mapping_entry(0x1600, 2, "RPDO mapping entry 2", 0x607A0020, "L514"),
    mapping_entry(0x1600, 3, "RPDO mapping entry 3", 0x60FF0020, "L515"),
    mapping_entry(0x1600, 4, "RPDO mapping entry 4", 0x68400010, "L516"),
    mapping_entry(0x1600, 5, "RPDO mapping entry 5", 0x687A0020, "L517"),
    mapping_entry(0x1600, 6, "RPDO mapping entry 6", 0x68FF0020, "L518"),
    mapping_entry(0x1600, 7, "RPDO mapping entry 7", 0x70400010, "L519"),
    mapping_entry(0x1600, 8, "RPDO mapping entry 8", 0x707A0020, "L520"),
    mapping_entry(0x1600, 9, "RPDO mapping entry 9", 0x70FF0020, "L521"),
    {.index = 0x1A00,
     .name = "Number of mapped application objects in TPDO",
     .object_code = record,
     .type = unsigned8,
     .default_value = 9,
     .range = Range{0, 9},
     .source = "L536-L538",
     .object_name = "Transmit PDO mapping parameter",
     .write_states = dictionary::kPreOperationalOnly},
    mapping_entry(0x1A00, 1, "TPDO mapping entry 1", 0x60410010, "L540"),
    mapping_entry(0x1A00, 2, "TPDO mapping entry 2", 0x60640020, "L541",
                  "Document prints 60640008h (bit length 8), contradicting INTEGER32 and the other "
                  "two axes; corrected here to 60640020h. See A-04."),
    mapping_entry(0x1A00, 3, "TPDO mapping entry 3", 0x606C0020, "L542"),
    mapping_entry(0x1A00, 4, "TPDO mapping entry 4", 0x68410010, "L543"),
    mapping_entry(0x1A00, 5, "TPDO mapping entry 5", 0x68640020, "L544"),
    mapping_entry(0x1A00, 6, "TPDO mapping entry 6", 0x686C0020, "L545"),
    mapping_entry(0x1A00, 7, "TPDO mapping entry 7", 0x70410010, "L546"),
    mapping_entry(0x1A00, 8, "TPDO mapping entry 8", 0x70640020, "L547"),
    mapping_entry(0x1A00, 9, "TPDO mapping entry 9", 0x706C0020, "L548"),
});

// Which sync manager carries what (§3.1.9-3.1.11).
constexpr auto kSyncManagers = std::to_array<EntryDeclaration>({
    {.index = 0x1C00,
     .name = "Number of entries",
     .object_code = record,
     .type = unsigned8,
     .default_value = 4,
     .range = Range{0, 3},
     .source = "L572",
     .note = "Printed range 0..3 contradicts default 4; use 4. See A-07.",
     .object_name = "Sync manager communication type",
     .legal_values = kSyncManagerCount,
     .write_states = dictionary::kPreOperationalOnly},
    {.index = 0x1C00,
     .subindex = 1,
     .name = "Communication type sync manager 1",
     .object_code = record,
     .type = unsigned8,
     .default_value = 1,
     .range = Range{1, 4},
     .unit = "enum",
     .source = "L573",
     .note = "Numbered from 1, so entry 1 is SM0. Normally fixed. See A-06 for swapped type 3/4 "
             "wording.",
     .legal_values = kSyncManagerType1,
     .write_states = dictionary::kPreOperationalOnly},
    {.index = 0x1C00,
     .subindex = 2,
     .name = "Communication type sync manager 2",
     .object_code = record,
     .type = unsigned8,
     .default_value = 2,
     .range = Range{1, 4},
     .unit = "enum",
     .source = "L574",
     .note = "Numbered from 1, so entry 2 is SM1. Normally fixed. See A-06 for swapped type 3/4 "
             "wording.",
     .legal_values = kSyncManagerType2,
     .write_states = dictionary::kPreOperationalOnly},
    {.index = 0x1C00,
     .subindex = 3,
     .name = "Communication type sync manager 3",
     .object_code = record,
     .type = unsigned8,
     .default_value = 3,
     .range = Range{1, 4},
     .unit = "enum",
     .source = "L575",
     .note = "Numbered from 1, so entry 3 is SM2. Normally fixed. See A-06 for swapped type 3/4 "
             "wording.",
     .legal_values = kSyncManagerType3,
     .write_states = dictionary::kPreOperationalOnly},
    {.index = 0x1C00,
     .subindex = 4,
     .name = "Communication type sync manager 4",
     .object_code = record,
     .type = unsigned8,
     .default_value = 4,
     .range = Range{1, 4},
     .unit = "enum",
     .source = "L576",
     .note = "Numbered from 1, so entry 4 is SM3. Normally fixed. See A-06 for swapped type 3/4 "
             "wording.",
     .legal_values = kSyncManagerType4,
     .write_states = dictionary::kPreOperationalOnly},
    {.index = 0x1C12,
     .name = "Number of assigned PDOs (SM2)",
     .object_code = record,
     .type = unsigned8,
     .default_value = 1,
     .range = kSwitch,
     .source = "L591",
     .object_name = "Sync manager 2 PDO assignment",
     .write_states = dictionary::kPreOperationalOnly},
    {.index = 0x1C12,
     .subindex = 1,
     .name = "PDO mapping index of assigned RPDO",
     .object_code = record,
     .type = unsigned16,
     .default_value = hex(0x1600),
     .range = kAnyUnsigned16,
     .source = "L592",
     .write_states = dictionary::kPreOperationalOnly},
    {.index = 0x1C13,
     .name = "Number of assigned PDOs (SM3)",
     .object_code = record,
     .type = unsigned8,
     .default_value = 1,
     .range = kSwitch,
     .source = "L608",
     .object_name = "Sync manager 3 PDO assignment",
     .write_states = dictionary::kPreOperationalOnly},
    {.index = 0x1C13,
     .subindex = 1,
     .name = "PDO mapping index of assigned TPDO",
     .object_code = record,
     .type = unsigned16,
     .default_value = hex(0x1A00),
     .range = kAnyUnsigned16,
     .source = "L609",
     .write_states = dictionary::kPreOperationalOnly},
});

}  // namespace

void add_communication_objects(dictionary::Dictionary& dictionary, FirmwareVersion firmware) {
  switch (firmware) {
    case FirmwareVersion::v1_07:
      dictionary.add(kIdentification107);
      break;
    case FirmwareVersion::v1_08:
      dictionary.add(kIdentification108);
      break;
    case FirmwareVersion::v1_09:
      dictionary.add(kIdentification);
      break;
  }
  dictionary.add(kPdoMapping);
  dictionary.add(kSyncManagers);
}

}  // namespace stator::devices::tmcm_3315
