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

// What CiA 301 wants besides, and process data of all that can be mapped, come from the firmware's
// shell (product::StandardObjects).
constexpr auto kDevice = std::to_array<EntryDeclaration>({
    // Profile 402 in the low word, a stepper drive in the high one (CiA 402-2).
    {.index = 0x1000, .name = "Device type", .access = constant, .default_value = hex(0x00040192)},
    {.index = 0x100A,
     .name = "Manufacturer software version",
     .type = visible_string,
     .access = constant,
     .default_value = "1.0"},
});

constexpr std::string_view kPosition = "microstep";
constexpr std::string_view kVelocity = "microstep/s";
constexpr std::string_view kAcceleration = "microstep/s^2";

// Power drive system and modes of operation (CiA 402-2 §8, §9).
constexpr auto kDrive = std::to_array<EntryDeclaration>({
    {.index = 0x603F, .name = "Error code", .type = unsigned16, .access = read_only},
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

void add_objects(stator::dictionary::Dictionary& dictionary) {
  dictionary.add(kDevice);
  dictionary.add(kDrive);
  dictionary.add(kMotion);
  dictionary.add(kHoming);
}

}  // namespace own_product
