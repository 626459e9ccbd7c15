#include "stator/canopen/node_id.hpp"
#include "stator/devices/tmcc160/object_groups.hpp"

namespace stator::devices::tmcc160 {

namespace {

using dictionary::EntryDeclaration;
using dictionary::Range;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;
using enum dictionary::Access;

// Digital inputs (2702h).
constexpr auto kDigitalInputs = std::to_array<EntryDeclaration>({
    {.index = 0x2702,
     .name = "Digital inputs",
     .access = read_only,
     .default_value = 0,
     .range = Range{0, 7},
     .unit = "bit field",
     .source = "L1344-L1360",
     .note =
         "Bit 0 left, bit 1 right limit switch status; third bit of the range not explained. A-32",
     .live = true},
});
constexpr auto kMappableDigitalInputs = mappable(kDigitalInputs);

// Node-ID (2705h).
constexpr auto kNodeId = std::to_array<EntryDeclaration>({
    {.index = 0x2705,
     .name = "Node ID",
     .type = unsigned8,
     .default_value = 1,
     .range = Range{1, 127},
     .source = "L1385-L1403",
     .note = "Effective after store and reset."},
});
/// Of a drive that LSS can leave without a node-ID.
constexpr auto kNodeIdOrNone = [] {
  auto rows = kNodeId;
  rows[0].range = Range{1, canopen::kUnconfiguredNodeId};
  rows[0].note = "Effective after store and reset. 255: none, until LSS gives one. H-08";
  return rows;
}();

// Bit rate, storing, and what is in use (2704h, 2706h to 2708h).
constexpr auto kNetwork = std::to_array<EntryDeclaration>({
    {.index = 0x2704,
     .name = "CAN bit rate",
     .type = unsigned16,
     .default_value = 1000,
     .range = Range{20, 1000},
     .unit = "kbit/s",
     .source = "L1362-L1383",
     .note = "Only 20 50 100 125 250 500 800 1000. Effective after store and reset.",
     .legal_values = kBitRates},
    {.index = 0x2706,
     .name = "Store",
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = "signature",
     .source = "L1401-L1419",
     .note =
         "Write 65766173h: stores 2704h and 2705h. Public EDS has it as array with sub 01. A-18"},
    {.index = 0x2707,
     .name = "CAN bit rate load",
     .type = unsigned16,
     .access = read_only,
     .default_value = 1000,
     .range = Range{20, 1000},
     .unit = "kbit/s",
     .source = "L1420-L1447",
     .note = "Printed type UNSIGNED8 cannot hold 1000; UNSIGNED16 used (public EDS). A-31",
     .live = true},
    {.index = 0x2708,
     .name = "Node ID load",
     .type = unsigned8,
     .access = read_only,
     .default_value = 1,
     .range = Range{1, 127},
     .source = "L1448-L1459",
     .note = "Node ID in use",
     .live = true},
});

// Analog inputs (270Eh).
constexpr auto kAnalogInputs = std::to_array<EntryDeclaration>({
    highest_subindex(0x270E, record, 7, "Analog inputs: highest sub-index", "Analog inputs",
                     "L1461-L1493"),
    {.index = 0x270E,
     .subindex = 1,
     .name = "ADC_IN_0",
     .object_code = record,
     .access = read_only,
     .default_value = 0,
     .range = kTwelveBitRange,
     .unit = "ADC counts (12 bit)",
     .source = "L1485",
     .note = "Public EDS lists a different set of 6. A-33. data type of the entry not printed "
             "(only \"Record\"); from value range and public EDS, A-43",
     .live = true},
    {.index = 0x270E,
     .subindex = 2,
     .name = "ADC_IN_1",
     .object_code = record,
     .access = read_only,
     .default_value = 0,
     .range = kTwelveBitRange,
     .unit = "ADC counts (12 bit)",
     .source = "L1486",
     .note = "Public EDS lists a different set of 6. A-33. data type of the entry not printed "
             "(only \"Record\"); from value range and public EDS, A-43",
     .live = true},
    {.index = 0x270E,
     .subindex = 3,
     .name = "ADC_phase_A",
     .object_code = record,
     .access = read_only,
     .default_value = 0,
     .range = kTwelveBitRange,
     .unit = "ADC counts (12 bit)",
     .source = "L1487",
     .note = "Public EDS lists a different set of 6. A-33. data type of the entry not printed "
             "(only \"Record\"); from value range and public EDS, A-43",
     .live = true},
    {.index = 0x270E,
     .subindex = 4,
     .name = "ADC_phase_B",
     .object_code = record,
     .access = read_only,
     .default_value = 0,
     .range = kTwelveBitRange,
     .unit = "ADC counts (12 bit)",
     .source = "L1488",
     .note = "Public EDS lists a different set of 6. A-33. data type of the entry not printed "
             "(only \"Record\"); from value range and public EDS, A-43",
     .live = true},
    {.index = 0x270E,
     .subindex = 5,
     .name = "ADC_phase_C",
     .object_code = record,
     .access = read_only,
     .default_value = 0,
     .range = kTwelveBitRange,
     .unit = "ADC counts (12 bit)",
     .source = "L1489",
     .note = "Public EDS lists a different set of 6. A-33. data type of the entry not printed "
             "(only \"Record\"); from value range and public EDS, A-43",
     .live = true},
    {.index = 0x270E,
     .subindex = 6,
     .name = "ADC_VSupply",
     .object_code = record,
     .access = read_only,
     .default_value = 0,
     .range = kTwelveBitRange,
     .unit = "ADC counts (12 bit)",
     .source = "L1490",
     .note = "Public EDS lists a different set of 6. A-33. data type of the entry not printed "
             "(only \"Record\"); from value range and public EDS, A-43",
     .live = true},
    {.index = 0x270E,
     .subindex = 7,
     .name = "ADC_Temp",
     .object_code = record,
     .access = read_only,
     .default_value = 0,
     .range = kTwelveBitRange,
     .unit = "ADC counts (12 bit)",
     .source = "L1491",
     .note = "Public EDS lists a different set of 6. A-33. data type of the entry not printed "
             "(only \"Record\"); from value range and public EDS, A-43",
     .live = true},
});

}  // namespace

void add_module_objects(dictionary::Dictionary& dictionary, const Options& options) {
  dictionary.add(options.maps_as_maker_eds ? kMappableDigitalInputs : kDigitalInputs);
  dictionary.add(options.lss ? kNodeIdOrNone : kNodeId);
  dictionary.add(kNetwork);
  dictionary.add(kAnalogInputs);
}

}  // namespace stator::devices::tmcc160
