// Objects of CiA 402 on a TMC8670: power state machine, modes, position, velocity, torque, pins.
#include <array>

#include "stator/devices/tmc8670/object_groups.hpp"

namespace stator::devices::tmc8670 {

namespace {

using dictionary::EntryDeclaration;
using dictionary::hex;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;
using enum dictionary::Access;
using enum dictionary::PdoMapping;

constexpr std::array<std::int64_t, 8> kModesOfOperation{0, 1, 3, 4, 6, 8, 9, 10};
// The codes of CiA 402 that the drive obeys (F-88).
constexpr std::array<std::int64_t, 5> kQuickStopOptions{0, 1, 2, 5, 6};
constexpr std::array<std::int64_t, 2> kShutdownOptions{0, 1};
constexpr std::array<std::int64_t, 2> kDisableOperationOptions{0, 1};
constexpr std::array<std::int64_t, 4> kHaltOptions{1, 2, 3, 4};
constexpr std::array<std::int64_t, 3> kFaultReactionOptions{0, 1, 2};

constexpr EntryDeclaration option_code(std::uint16_t index, std::string_view name,
                                       std::int64_t preset, base::StaticList codes) {
  return within({codes.view().front(), codes.view().back()},
                one_of(codes, entry(index, 0, name, variable, integer16, read_write, no, preset, "",
                                    kProfile)));
}

// Errors, power state machine, modes of operation.
constexpr auto kPowerStateMachine = std::to_array<EntryDeclaration>({
    entry(0x603F, 0, "Error code", variable, unsigned16, read_only, transmit, 0, "", kProfile),
    entry(0x6040, 0, "Controlword", variable, unsigned16, read_write, receive, 0, "", kProfile),
    entry(0x6041, 0, "Statusword", variable, unsigned16, read_only, transmit, 0, "", kProfile),
    option_code(0x605A, "Quick stop option code", 2, kQuickStopOptions),
    option_code(0x605B, "Shutdown option code", 0, kShutdownOptions),
    option_code(0x605C, "Disable operation option code", 1, kDisableOperationOptions),
    option_code(0x605D, "Halt option code", 1, kHaltOptions),
    option_code(0x605E, "Fault reaction option code", 2, kFaultReactionOptions),
    one_of(kModesOfOperation, entry(0x6060, 0, "Modes of operation", variable, integer8, read_write,
                                    receive, 0, "", "CiA 402 / IEC 61800-7-201; 0 1 3 4 6 8 9 10")),
    entry(0x6061, 0, "Modes of operation display", variable, integer8, read_only, transmit, 0, "",
          kProfile),
});

// Position and velocity, as measured and demanded.
constexpr auto kPositionAndVelocity = std::to_array<EntryDeclaration>({
    entry(0x6062, 0, "Position demand value", variable, integer32, read_only, transmit, 0,
          "position units", kProfile),
    entry(0x6063, 0, "Position actual internal value", variable, integer32, read_only, transmit, 0,
          "1/65536 revolution", "CiA 402 / IEC 61800-7-201; one revolution = 65536 (L1016)"),
    entry(0x6064, 0, "Position actual value", variable, integer32, read_only, transmit, 0,
          "position units", kProfile),
    entry(0x6065, 0, "Following error window", variable, unsigned32, read_write, no,
          hex(0xFFFFFFFF), "position units", kProfile),
    entry(0x6066, 0, "Following error time out", variable, unsigned16, read_write, no, 0, "ms",
          kProfile),
    entry(0x6067, 0, "Position window", variable, unsigned32, read_write, no, 1000,
          "position units", kProfile),
    entry(0x6068, 0, "Position window time", variable, unsigned16, read_write, no, 0, "ms",
          kProfile),
    entry(0x606B, 0, "Velocity demand value", variable, integer32, read_only, transmit, 0, "rpm",
          kProfile),
    entry(0x606C, 0, "Velocity actual value", variable, integer32, read_only, transmit, 0, "rpm",
          kProfile),
    entry(0x606D, 0, "Velocity window", variable, unsigned16, read_write, no, 0, "rpm", kProfile),
    entry(0x606E, 0, "Velocity window time", variable, unsigned16, read_write, no, 0, "ms",
          kProfile),
    entry(0x606F, 0, "Velocity threshold", variable, unsigned16, read_write, no, 0, "rpm",
          kProfile),
    entry(0x6070, 0, "Velocity threshold time", variable, unsigned16, read_write, no, 0, "ms",
          kProfile),
});

// Torque in 0.1 % of the rated torque.
constexpr auto kTorque = std::to_array<EntryDeclaration>({
    entry(0x6071, 0, "Target torque", variable, integer16, read_write, receive, 0,
          "0.1 % of rated torque", kProfile),
    entry(0x6072, 0, "Max torque", variable, unsigned16, read_write, receive, 1000, "0.1 %",
          kProfile),
    entry(0x6073, 0, "Max current", variable, unsigned16, read_write, no, 1000, "0.1 %", kProfile),
    entry(0x6074, 0, "Torque demand value", variable, integer16, read_only, transmit, 0, "0.1 %",
          kProfile),
    entry(0x6075, 0, "Motor rated current", variable, unsigned32, read_write, no, 1000, "mA",
          kProfile),
    entry(0x6076, 0, "Motor rated torque", variable, unsigned32, read_write, no, 1000, "mNm",
          kProfile),
    entry(0x6077, 0, "Torque actual value", variable, integer16, read_only, transmit, 0, "0.1 %",
          kProfile),
    entry(0x6078, 0, "Current actual value", variable, integer16, read_only, transmit, 0, "0.1 %",
          kProfile),
    entry(0x6079, 0, "DC link circuit voltage", variable, unsigned32, read_only, transmit, 0, "mV",
          "CiA 402 / IEC 61800-7-201; from ADC_VM (L430)"),
});

// Pins, what the drive can do.
constexpr auto kPins = std::to_array<EntryDeclaration>({
    entry(0x60FD, 0, "Digital inputs", variable, unsigned32, read_only, transmit, 0, "",
          "CiA 402 / IEC 61800-7-201; bit 0 left, 1 right, 2 home (A-53)"),
    titled("Digital outputs", entry(0x60FE, 0, "Digital outputs: number of entries", array,
                                    unsigned8, read_only, no, 2, "", kProfile)),
    entry(0x60FE, 1, "Digital outputs: physical outputs", array, unsigned32, read_write, receive, 0,
          "", kProfile),
    entry(0x60FE, 2, "Digital outputs: bit mask", array, unsigned32, read_write, no, 0, "",
          kProfile),
    entry(0x60FF, 0, "Target velocity", variable, integer32, read_write, receive, 0, "rpm",
          kProfile),
    entry(0x6502, 0, "Supported drive modes", variable, unsigned32, read_only, no, hex(0x000003AD),
          "", "CiA 402 / IEC 61800-7-201; bits 0 pp, 2 pv, 3 tq, 5 hm, 7 csp, 8 csv, 9 cst"),
});

}  // namespace

void add_profile_drive_objects(dictionary::Dictionary& dictionary) {
  dictionary.add(kPowerStateMachine);
  dictionary.add(kPositionAndVelocity);
  dictionary.add(kTorque);
  dictionary.add(kPins);
}

}  // namespace stator::devices::tmc8670
