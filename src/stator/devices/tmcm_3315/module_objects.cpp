#include "stator/devices/tmcm_3315/object_groups.hpp"

namespace stator::devices::tmcm_3315 {

namespace {

using dictionary::EntryDeclaration;
using dictionary::undocumented;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;
using enum dictionary::Access;
using enum dictionary::PdoMapping;

// General-purpose inputs (§4.2.64).
constexpr auto kDigitalInputs = std::to_array<EntryDeclaration>({
    {.index = 0x2702,
     .name = "Device digital inputs",
     .access = read_only,
     .mapping = transmit,
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = "bit field",
     .source = "L1667-L1689",
     .note = "Bits 16..19 = IN0..IN3. Document says PDO \"yes\"; one instance for the module "
             "(outside all per-axis ranges), see A-34."},
});

// General-purpose outputs (§4.2.65).
constexpr auto kDigitalOutputs = std::to_array<EntryDeclaration>({
    inferred_highest_subindex(0x2703, array, 2, "Device digital outputs", "L1702-L1714"),
    {.index = 0x2703,
     .subindex = 1,
     .name = "Physical outputs",
     .object_code = array,
     .mapping = receive,
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = "bit field",
     .source = "L1711",
     .note = "Bits 16..19 = OUT0..OUT3. Document says PDO \"yes\" without direction."},
    {.index = 0x2703,
     .subindex = 2,
     .name = "Output mask",
     .object_code = array,
     .mapping = receive,
     .default_value = 0,
     .range = kAnyUnsigned32,
     .unit = "bit field",
     .source = "L1712",
     .note = "1 = output may be switched by sub 01. Default 0 blocks every output. Document says "
             "PDO \"yes\" without direction."},
});

// Analog inputs (§4.2.66).
constexpr auto kAnalogInputs = std::to_array<EntryDeclaration>({
    inferred_highest_subindex(0x270E, array, 4, "Device analog inputs", "L1721-L1734"),
    {.index = 0x270E,
     .subindex = 1,
     .name = "Analog input 0",
     .object_code = array,
     .access = read_only,
     .mapping = transmit,
     .default_value = undocumented(0),
     .range = kAnyUnsigned16,
     .unit = "ADC counts",
     .source = "L1729",
     .note = "32-bit object carrying a 16-bit value; scaling to volts not given."},
    {.index = 0x270E,
     .subindex = 2,
     .name = "Analog input 1",
     .object_code = array,
     .access = read_only,
     .mapping = transmit,
     .default_value = undocumented(0),
     .range = kAnyUnsigned16,
     .unit = "ADC counts",
     .source = "L1730",
     .note = "32-bit object carrying a 16-bit value; scaling to volts not given."},
    {.index = 0x270E,
     .subindex = 3,
     .name = "Analog input 2",
     .object_code = array,
     .access = read_only,
     .mapping = transmit,
     .default_value = undocumented(0),
     .range = kAnyUnsigned16,
     .unit = "ADC counts",
     .source = "L1731",
     .note = "32-bit object carrying a 16-bit value; scaling to volts not given."},
    {.index = 0x270E,
     .subindex = 4,
     .name = "Analog input 3",
     .object_code = array,
     .access = read_only,
     .mapping = transmit,
     .default_value = undocumented(0),
     .range = kAnyUnsigned16,
     .unit = "ADC counts",
     .source = "L1732",
     .note = "32-bit object carrying a 16-bit value; scaling to volts not given."},
});

}  // namespace

void add_module_objects(dictionary::Dictionary& dictionary) {
  dictionary.add(kDigitalInputs);
  dictionary.add(kDigitalOutputs);
  dictionary.add(kAnalogInputs);
}

}  // namespace stator::devices::tmcm_3315
