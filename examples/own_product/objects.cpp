#include "own_product/objects.hpp"

#include <cstdint>
#include <string_view>

#include "own_product/own_stepper.hpp"

namespace own_product {

namespace {

using namespace stator::dictionary;
using enum DataType;
using enum ObjectCode;
using enum Access;
using enum PdoMapping;

constexpr std::array<std::int64_t, 6> kModes{0, 1, 3, 6, 8, 9};
constexpr std::array<std::int64_t, 4> kQuickStopOptions{1, 2, 5, 6};
constexpr std::array<std::int64_t, 1> kDisableVoltage{0};
constexpr std::array<std::int64_t, 1> kSlowDownRamp{1};
constexpr std::array<std::int64_t, 1> kQuickStopRamp{2};
constexpr std::array<std::int64_t, 2> kSensors{-1, 0};
constexpr std::array<std::int64_t, 6> kHomingMethods{0, 17, 18, 19, 21, 35};

/// A row of an array or record that nobody can change.
constexpr EntryDeclaration fixed(std::uint16_t index, std::uint8_t subindex, std::string_view name,
                                 ObjectCode code, DataType type, Default value) {
  return {.index = index,
          .subindex = subindex,
          .name = name,
          .object_code = code,
          .type = type,
          .access = constant,
          .default_value = value,
          .object_name = subindex == 0 ? name : std::string_view()};
}

// A row without a range takes every value of its type.

// Identity, errors (CiA 301 §7.5.2).
constexpr auto kIdentity = std::to_array<EntryDeclaration>({
    // Profile 402 in the low word, a stepper drive in the high one (CiA 402-2).
    {.index = 0x1000, .name = "Device type", .access = constant, .default_value = hex(0x00040192)},
    {.index = 0x1001,
     .name = "Error register",
     .type = unsigned8,
     .access = read_only,
     .mapping = transmit},
    {.index = 0x1008,
     .name = "Manufacturer device name",
     .type = visible_string,
     .access = constant,
     .default_value = "Own stepper"},
    {.index = 0x100A,
     .name = "Manufacturer software version",
     .type = visible_string,
     .access = constant,
     .default_value = "1.0"},
    fixed(0x1018, 0, "Identity object", record, unsigned8, 4),
    fixed(0x1018, 1, "Vendor ID", record, unsigned32, hex(kVendorId)),
    fixed(0x1018, 2, "Product code", record, unsigned32, hex(kProductCode)),
    fixed(0x1018, 3, "Revision number", record, unsigned32, hex(kRevision)),
    fixed(0x1018, 4, "Serial number", record, unsigned32, 0),
});

// Process data: one PDO in each direction, which masters cannot change.
constexpr auto kProcessData = std::to_array<EntryDeclaration>({
    fixed(0x1600, 0, "Receive PDO mapping", record, unsigned8, 4),
    fixed(0x1600, 1, "Mapped object", record, unsigned32, hex(0x60400010)),
    fixed(0x1600, 2, "Mapped object", record, unsigned32, hex(0x60600008)),
    fixed(0x1600, 3, "Mapped object", record, unsigned32, hex(0x607A0020)),
    fixed(0x1600, 4, "Mapped object", record, unsigned32, hex(0x60FF0020)),
    fixed(0x1A00, 0, "Transmit PDO mapping", record, unsigned8, 4),
    fixed(0x1A00, 1, "Mapped object", record, unsigned32, hex(0x60410010)),
    fixed(0x1A00, 2, "Mapped object", record, unsigned32, hex(0x60610008)),
    fixed(0x1A00, 3, "Mapped object", record, unsigned32, hex(0x60640020)),
    fixed(0x1A00, 4, "Mapped object", record, unsigned32, hex(0x606C0020)),
    fixed(0x1C00, 0, "Sync manager communication type", array, unsigned8, 4),
    fixed(0x1C00, 1, "Mailbox receive", array, unsigned8, 1),
    fixed(0x1C00, 2, "Mailbox send", array, unsigned8, 2),
    fixed(0x1C00, 3, "Process data outputs", array, unsigned8, 3),
    fixed(0x1C00, 4, "Process data inputs", array, unsigned8, 4),
    fixed(0x1C12, 0, "Sync manager 2 PDO assignment", array, unsigned8, 1),
    fixed(0x1C12, 1, "Assigned PDO", array, unsigned16, hex(0x1600)),
    fixed(0x1C13, 0, "Sync manager 3 PDO assignment", array, unsigned8, 1),
    fixed(0x1C13, 1, "Assigned PDO", array, unsigned16, hex(0x1A00)),
});

constexpr std::string_view kPosition = "microstep";
constexpr std::string_view kVelocity = "microstep/s";
constexpr std::string_view kAcceleration = "microstep/s^2";

// Power drive system and modes of operation (CiA 402-2 §8, §9).
constexpr auto kDrive = std::to_array<EntryDeclaration>({
    {.index = 0x603F,
     .name = "Error code",
     .type = unsigned16,
     .access = read_only,
     .mapping = transmit},
    {.index = 0x6040, .name = "Controlword", .type = unsigned16, .mapping = receive},
    {.index = 0x6041,
     .name = "Statusword",
     .type = unsigned16,
     .access = read_only,
     .mapping = transmit},
    {.index = 0x605A,
     .name = "Quick stop option code",
     .type = integer16,
     .default_value = 2,
     .legal_values = kQuickStopOptions},
    {.index = 0x605B,
     .name = "Shutdown option code",
     .type = integer16,
     .default_value = 0,
     .legal_values = kDisableVoltage},
    {.index = 0x605C,
     .name = "Disable operation option code",
     .type = integer16,
     .default_value = 1,
     .legal_values = kSlowDownRamp},
    {.index = 0x605D,
     .name = "Halt option code",
     .type = integer16,
     .default_value = 1,
     .legal_values = kSlowDownRamp},
    {.index = 0x605E,
     .name = "Fault reaction option code",
     .type = integer16,
     .default_value = 2,
     .legal_values = kQuickStopRamp},
    {.index = 0x6060,
     .name = "Modes of operation",
     .type = integer8,
     .mapping = receive,
     .legal_values = kModes},
    {.index = 0x6061,
     .name = "Modes of operation display",
     .type = integer8,
     .access = read_only,
     .mapping = transmit},
    // pp, pv, hm, csp, csv: bits 0, 2, 5, 7 and 8.
    {.index = 0x6502,
     .name = "Supported drive modes",
     .access = constant,
     .default_value = hex(0x000001A5)},
});

// Positions and velocities (CiA 402-2 §10, §16).
constexpr auto kMotion = std::to_array<EntryDeclaration>({
    {.index = 0x6062,
     .name = "Position demand value",
     .type = integer32,
     .access = read_only,
     .mapping = transmit,
     .unit = kPosition},
    {.index = 0x6063,
     .name = "Position actual internal value",
     .type = integer32,
     .access = read_only,
     .mapping = transmit,
     .unit = kPosition},
    {.index = 0x6064,
     .name = "Position actual value",
     .type = integer32,
     .access = read_only,
     .mapping = transmit,
     .unit = kPosition},
    {.index = 0x6067,
     .name = "Position window",
     .default_value = hex(0xFFFFFFFF),
     .unit = kPosition},
    // -1: the position is that of the ramp; 0: that of the encoder.
    {.index = 0x606A,
     .name = "Sensor selection code",
     .type = integer16,
     .default_value = -1,
     .legal_values = kSensors},
    {.index = 0x606C,
     .name = "Velocity actual value",
     .type = integer32,
     .access = read_only,
     .mapping = transmit,
     .unit = kVelocity},
    {.index = 0x607A,
     .name = "Target position",
     .type = integer32,
     .mapping = receive,
     .unit = kPosition},
    fixed(0x607D, 0, "Software position limit", array, unsigned8, 2),
    {.index = 0x607D,
     .subindex = 1,
     .name = "Minimum position limit",
     .object_code = array,
     .type = integer32,
     .default_value = -2147483648,
     .unit = kPosition},
    {.index = 0x607D,
     .subindex = 2,
     .name = "Maximum position limit",
     .object_code = array,
     .type = integer32,
     .default_value = 2147483647,
     .unit = kPosition},
    {.index = 0x6081, .name = "Profile velocity", .default_value = 51200, .unit = kVelocity},
    {.index = 0x6083,
     .name = "Profile acceleration",
     .default_value = 102400,
     .unit = kAcceleration},
    {.index = 0x6084,
     .name = "Profile deceleration",
     .default_value = 102400,
     .unit = kAcceleration},
    {.index = 0x6085,
     .name = "Quick stop deceleration",
     .default_value = 512000,
     .unit = kAcceleration},
    fixed(0x608F, 0, "Position encoder resolution", array, unsigned8, 2),
    {.index = 0x608F,
     .subindex = 1,
     .name = "Encoder increments",
     .object_code = array,
     .default_value = 40000},
    fixed(0x608F, 2, "Motor revolutions", array, unsigned32, 1),
    fixed(0x60C2, 0, "Interpolation time period", record, unsigned8, 2),
    {.index = 0x60C2,
     .subindex = 1,
     .name = "Interpolation time period value",
     .object_code = record,
     .type = unsigned8,
     .default_value = 1},
    {.index = 0x60C2,
     .subindex = 2,
     .name = "Interpolation time index",
     .object_code = record,
     .type = integer8,
     .default_value = -3},
    {.index = 0x60FF,
     .name = "Target velocity",
     .type = integer32,
     .mapping = receive,
     .unit = kVelocity},
});

// Homing (CiA 402-2 §11).
constexpr auto kHoming = std::to_array<EntryDeclaration>({
    {.index = 0x607C, .name = "Home offset", .type = integer32, .unit = kPosition},
    {.index = 0x6098,
     .name = "Homing method",
     .type = integer8,
     .default_value = 35,
     .legal_values = kHomingMethods},
    fixed(0x6099, 0, "Homing speeds", array, unsigned8, 2),
    {.index = 0x6099,
     .subindex = 1,
     .name = "Speed during search for switch",
     .object_code = array,
     .default_value = 25600,
     .unit = kVelocity},
    {.index = 0x6099,
     .subindex = 2,
     .name = "Speed during search for zero",
     .object_code = array,
     .default_value = 2560,
     .unit = kVelocity},
    {.index = 0x609A,
     .name = "Homing acceleration",
     .default_value = 102400,
     .unit = kAcceleration},
});

}  // namespace

stator::dictionary::Dictionary& add_objects(stator::dictionary::Dictionary& dictionary) {
  dictionary.add(kIdentity);
  dictionary.add(kProcessData);
  dictionary.add(kDrive);
  dictionary.add(kMotion);
  dictionary.add(kHoming);
  dictionary.finish();
  return dictionary;
}

}  // namespace own_product
