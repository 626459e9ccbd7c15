// Manufacturer objects of a TMC8670 beyond its FOC settings: firmware, further fields of the block,
// measurements, registers.
#include <array>

#include "stator/devices/tmc8670/object_groups.hpp"

namespace stator::devices::tmc8670 {

namespace {

using dictionary::EntryDeclaration;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;
using enum dictionary::Access;
using enum dictionary::PdoMapping;

constexpr std::array<std::int64_t, 2> kSwitch{0, 1};
constexpr std::array<std::int64_t, 2> kAnalogPhases{0, 1};
constexpr std::array<std::int64_t, 2> kVelocityMeters{0, 1};

constexpr EntryDeclaration parameter(std::uint16_t index, std::uint8_t subindex,
                                     std::string_view name, dictionary::DataType type,
                                     dictionary::Default value, std::string_view unit,
                                     std::string_view note = kVendor) {
  return entry(index, subindex, name, record, type, read_write, no, value, unit, note);
}
constexpr EntryDeclaration shown(std::uint16_t index, std::uint8_t subindex, std::string_view name,
                                 dictionary::DataType type, std::string_view unit,
                                 std::string_view note = kVendor) {
  return live(entry(index, subindex, name, record, type, read_only, transmit, 0, unit, note));
}
constexpr EntryDeclaration highest(std::uint16_t index, std::string_view title,
                                   std::string_view name, std::uint8_t subindex) {
  return titled(title,
                entry(index, 0, name, record, unsigned8, constant, no, subindex, "", kVendor));
}

// How the firmware brings the motor under control.
constexpr auto kFirmware = std::to_array<EntryDeclaration>({
    highest(0x2050, "Commutation", "Commutation: number of entries", 5),
    within({0, 3},
           parameter(
               0x2050, 1,
               "Commutation: method (0 as configured, 1 halls, 2 bang-bang, 3 minimal movement)",
               unsigned8, 1, "",
               "vendor object of the virtual device; methods named in the document at L889-L897")),
    parameter(0x2050, 2, "Commutation: current", unsigned32, 1000, "mA"),
    parameter(0x2050, 3, "Commutation: hold time", unsigned16, 500, "ms"),
    parameter(0x2050, 4, "Commutation: voltage of minimal movement", unsigned16, 3000, "1/32768"),
    parameter(0x2050, 5, "Commutation: largest movement", integer16, 16384, "1/65536"),
    highest(0x2051, "Supply", "Supply: number of entries", 5),
    within({1, 1000000},
           parameter(0x2051, 1, "Supply: voltage of a converter step", unsigned32, 1000, "uV")),
    parameter(0x2051, 2, "Supply: converter value at 0 V", unsigned16, 0, ""),
    parameter(0x2051, 3, "Supply: undervoltage", unsigned32, 7000, "mV"),
    parameter(0x2051, 4, "Supply: overvoltage", unsigned32, 60000, "mV"),
    parameter(0x2051, 5, "Supply: hysteresis", unsigned32, 500, "mV"),
    highest(0x2052, "Units and limits", "Units and limits: number of entries", 3),
    within({1, 1000000}, parameter(0x2052, 1, "Units and limits: current of a torque step",
                                   unsigned32, 1000, "uA")),
    within({1, 4294967295}, parameter(0x2052, 2, "Units and limits: largest acceleration",
                                      unsigned32, 4294967295, "rpm/s")),
    parameter(0x2052, 3, "Units and limits: standstill", unsigned16, 5, "rpm"),
    highest(0x2053, "Reference switches", "Reference switches: number of entries", 3),
    within({0, 7},
           parameter(0x2053, 1, "Reference switches: active high (bit 0 home, 1 left, 2 right)",
                     unsigned8, 0, "")),
    within({0, 7},
           parameter(0x2053, 2, "Reference switches: not used (bit 0 home, 1 left, 2 right)",
                     unsigned8, 0, "")),
    one_of(kSwitch, parameter(0x2053, 3, "Reference switches: home offset is the position at home",
                              unsigned8, 0, "")),
    highest(0x2054, "Brake", "Brake: number of entries", 3),
    parameter(0x2054, 1, "Brake: delay before release", unsigned16, 0, "ms"),
    parameter(0x2054, 2, "Brake: release time", unsigned16, 0, "ms"),
    parameter(0x2054, 3, "Brake: apply time", unsigned16, 0, "ms"),
    highest(0x2055, "Hard stop homing", "Hard stop homing: number of entries", 3),
    parameter(0x2055, 1, "Hard stop homing: current", unsigned32, 0, "mA"),
    parameter(0x2055, 2, "Hard stop homing: way back from the positive stop", integer32, 0,
              "position units"),
    parameter(0x2055, 3, "Hard stop homing: way back from the negative stop", integer32, 0,
              "position units"),
});

// Fields of the FOC block beyond 2000h-2040h that one sets once per machine.
constexpr auto kBlock = std::to_array<EntryDeclaration>({
    highest(0x2060, "Hall positions", "Hall positions: number of entries", 8),
    parameter(0x2060, 1, "Hall positions: 0 degrees", integer16, 0, "1/65536",
              "vendor object of the virtual device; parameter named in the document at L658"),
    parameter(0x2060, 2, "Hall positions: 60 degrees", integer16, 10922, "1/65536",
              "vendor object of the virtual device; parameter named in the document at L658"),
    parameter(0x2060, 3, "Hall positions: 120 degrees", integer16, 21845, "1/65536",
              "vendor object of the virtual device; parameter named in the document at L658"),
    parameter(0x2060, 4, "Hall positions: 180 degrees", integer16, -32768, "1/65536",
              "vendor object of the virtual device; parameter named in the document at L658"),
    parameter(0x2060, 5, "Hall positions: 240 degrees", integer16, -21846, "1/65536",
              "vendor object of the virtual device; parameter named in the document at L658"),
    parameter(0x2060, 6, "Hall positions: 300 degrees", integer16, -10923, "1/65536",
              "vendor object of the virtual device; parameter named in the document at L658"),
    parameter(0x2060, 7, "Hall positions: mechanical offset", integer16, 0, "1/65536"),
    parameter(0x2060, 8, "Hall positions: largest interpolation", unsigned16, 10922, "1/65536"),
    highest(0x2061, "Analog encoder decoder", "Analog encoder decoder: number of entries", 5),
    one_of(
        kAnalogPhases,
        parameter(0x2061, 1, "Analog encoder decoder: three phases", unsigned8, 0, "",
                  "vendor object of the virtual device; parameter named in the document at L699")),
    one_of(kSwitch, parameter(0x2061, 2, "Analog encoder decoder: direction", unsigned8, 0, "")),
    parameter(0x2061, 3, "Analog encoder decoder: periods per revolution", integer16, 1, ""),
    parameter(0x2061, 4, "Analog encoder decoder: mechanical offset", integer16, 0, "1/65536"),
    parameter(0x2061, 5, "Analog encoder decoder: angle offset", integer16, 0, "1/65536"),
    highest(0x2062, "Converters", "Converters: number of entries", 6),
    within(
        {0, 3},
        parameter(0x2062, 1, "Converters: group A (0 SPI, 1-3 delta sigma)", unsigned8, 0, "",
                  "vendor object of the virtual device; parameter named in the document at L692")),
    within(
        {0, 3},
        parameter(0x2062, 2, "Converters: group B (0 SPI, 1-3 delta sigma)", unsigned8, 0, "",
                  "vendor object of the virtual device; parameter named in the document at L692")),
    parameter(0x2062, 3, "Converters: decimation of group A", unsigned16, 334, ""),
    parameter(0x2062, 4, "Converters: decimation of group B", unsigned16, 334, ""),
    within(
        {0, 3},
        parameter(0x2062, 5, "Converters: channel of phase U", unsigned8, 0, "",
                  "vendor object of the virtual device; parameter named in the document at L867")),
    within(
        {0, 3},
        parameter(0x2062, 6, "Converters: channel of phase W", unsigned8, 1, "",
                  "vendor object of the virtual device; parameter named in the document at L867")),
    highest(0x2063, "Velocity and feed-forward", "Velocity and feed-forward: number of entries", 3),
    one_of(kVelocityMeters,
           parameter(0x2063, 1, "Velocity and feed-forward: velocity meter", unsigned8, 0, "")),
    within({0, 3}, parameter(0x2063, 2,
                             "Velocity and feed-forward: feed-forward (bit 0 velocity, 1 torque)",
                             unsigned8, 0, "")),
    parameter(0x2063, 3, "Velocity and feed-forward: velocity gain", integer32, 0, "1/65536"),
});

// What the FOC block measures and computes, for process data.
constexpr auto kMeasured = std::to_array<EntryDeclaration>({
    highest(0x2070, "FOC values", "FOC values: number of entries", 18),
    shown(0x2070, 1, "FOC values: I_D", integer16, ""),
    shown(0x2070, 2, "FOC values: I_Q", integer16, ""),
    shown(0x2070, 3, "FOC values: U_D", integer16, "1/32768"),
    shown(0x2070, 4, "FOC values: U_Q", integer16, "1/32768"),
    shown(0x2070, 5, "FOC values: phi_e", integer16, "1/65536"),
    shown(0x2070, 6, "FOC values: I_U", integer16, ""),
    shown(0x2070, 7, "FOC values: I_V", integer16, ""),
    shown(0x2070, 8, "FOC values: I_W", integer16, ""),
    shown(0x2070, 9, "FOC values: raw current 0", unsigned16, ""),
    shown(0x2070, 10, "FOC values: raw current 1", unsigned16, ""),
    shown(0x2070, 11, "FOC values: raw supply voltage", unsigned16, ""),
    shown(0x2070, 12, "FOC values: encoder count", unsigned32, ""),
    shown(0x2070, 13, "FOC values: encoder count at N", unsigned32, ""),
    shown(0x2070, 14, "FOC values: encoder 2 count", unsigned32, ""),
    shown(0x2070, 15, "FOC values: hall phi_e", integer16, "1/65536"),
    shown(0x2070, 16, "FOC values: analog encoder phi_e", integer16, "1/65536"),
    shown(0x2070, 17, "FOC values: position", integer32, "1/65536 revolution"),
    shown(0x2070, 18, "FOC values: status flags", unsigned32, ""),
});

// The firmware itself, and a way to every register.
constexpr auto kDiagnosis = std::to_array<EntryDeclaration>({
    highest(0x20F0, "Synchronisation monitor", "Synchronisation monitor: number of entries", 4),
    shown(0x20F0, 1, "Synchronisation monitor: SYNC0 pulses taken", unsigned32, ""),
    shown(0x20F0, 2, "Synchronisation monitor: error counter", unsigned16, "",
          "as 1C32h:20h of ETG.1020"),
    shown(0x20F0, 3, "Synchronisation monitor: cycles without outputs", unsigned32, "",
          "as 1C32h:0Bh of ETG.1020"),
    shown(0x20F0, 4, "Synchronisation monitor: synchronisation lost", unsigned32, ""),
    highest(0x2FF0, "FOC register access", "FOC register access: number of entries", 2),
    within({0, 127},
           entry(0x2FF0, 1, "FOC register access: address", record, unsigned8, read_write, receive,
                 0, "", "vendor object of the virtual device; registers as over the UART (L748)")),
    live(entry(0x2FF0, 2, "FOC register access: value", record, unsigned32, read_write, transmit, 0,
               "", "vendor object of the virtual device; registers as over the UART (L748)")),
});

}  // namespace

void add_firmware_objects(dictionary::Dictionary& dictionary) {
  dictionary.add(kFirmware);
  dictionary.add(kBlock);
  dictionary.add(kMeasured);
  dictionary.add(kDiagnosis);
}

}  // namespace stator::devices::tmc8670
