#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/canopen/emergency/emergency_producer.hpp"
#include "stator/drive/axis/axis_error.hpp"

namespace stator::devices::tmcc160 {

/// Bits of the error register 1001h (document L416-L432).
namespace error_register {
inline constexpr std::uint8_t kGeneric = 1U << 0;
inline constexpr std::uint8_t kCurrent = 1U << 1;
inline constexpr std::uint8_t kVoltage = 1U << 2;
inline constexpr std::uint8_t kTemperature = 1U << 3;
inline constexpr std::uint8_t kCommunication = 1U << 4;
inline constexpr std::uint8_t kDeviceProfile = 1U << 5;
inline constexpr std::uint8_t kManufacturer = 1U << 7;
}  // namespace error_register

// The emergency table (document L3393-L3505). Which bits of 1001h a code sets and which errors lead
// to the Fault state the document leaves open; decide. The second additional byte is
// 255 for errors of the device and 0 for those of its motor.

inline constexpr std::uint16_t kParameterError = 0x6320;
inline constexpr std::uint16_t kCommunicationError = 0x8100;

/// Rows that services of the node raise.
inline constexpr auto kServiceEmergencies = std::to_array<canopen::EmergencyRule>({
    {kParameterError, error_register::kGeneric | error_register::kDeviceProfile, {0, 255}},
    {kCommunicationError, error_register::kGeneric | error_register::kCommunication, {0, 255}},
    {0x8110, error_register::kGeneric | error_register::kCommunication, {0, 255}},  // byte 1: which
    {0x8120, error_register::kGeneric | error_register::kCommunication, {0, 255}},
    {0x8130, error_register::kGeneric | error_register::kCommunication, {0, 255}},
    {0x8140, error_register::kGeneric | error_register::kCommunication, {0, 255}},
    {0x8210, error_register::kGeneric | error_register::kCommunication, {0, 255}},
    {0x8220, error_register::kGeneric | error_register::kCommunication, {0, 255}},
});

/// A row that the axis raises.
struct AxisEmergency {
  drive::AxisError error{};
  std::uint16_t code = 0;
  std::uint8_t detail = 0;  ///< first additional byte
  std::uint8_t register_bits = 0;
  drive::ErrorReaction reaction{};
  bool of_device = false;  ///< second additional byte 255
  /// The document has no code for it: it shows in 200Dh and 1001h, and is told only where
  /// Options::undocumented_emergencies is set.
  bool documented = true;
};

inline constexpr std::array kAxisEmergencies{
    AxisEmergency{drive::AxisError::open_load_a, 0x1000, 1, error_register::kGeneric,
                  drive::ErrorReaction::warning},
    AxisEmergency{drive::AxisError::open_load_b, 0x1000, 2, error_register::kGeneric,
                  drive::ErrorReaction::warning},
    AxisEmergency{drive::AxisError::overcurrent_high_side, 0x2310, 0,
                  error_register::kGeneric | error_register::kCurrent,
                  drive::ErrorReaction::power_off},
    AxisEmergency{drive::AxisError::overcurrent_b, 0x2311, 0,
                  error_register::kGeneric | error_register::kCurrent,
                  drive::ErrorReaction::power_off},
    AxisEmergency{drive::AxisError::overcurrent_a, 0x2312, 0,
                  error_register::kGeneric | error_register::kCurrent,
                  drive::ErrorReaction::power_off},
    // The document names two bridges. A short of the third one loads its high side.
    AxisEmergency{drive::AxisError::overcurrent_c, 0x2310, 0,
                  error_register::kGeneric | error_register::kCurrent,
                  drive::ErrorReaction::power_off},
    AxisEmergency{drive::AxisError::stall, 0x3230, 0,
                  error_register::kGeneric | error_register::kDeviceProfile,
                  drive::ErrorReaction::stop},
    AxisEmergency{drive::AxisError::over_temperature_warning, 0x4310, 1,
                  error_register::kGeneric | error_register::kTemperature,
                  drive::ErrorReaction::warning},
    AxisEmergency{drive::AxisError::over_temperature, 0x4310, 2,
                  error_register::kGeneric | error_register::kTemperature,
                  drive::ErrorReaction::power_off},
    AxisEmergency{drive::AxisError::shutdown_switch, 0x5441, 0,
                  error_register::kGeneric | error_register::kManufacturer,
                  drive::ErrorReaction::power_off, true},
    AxisEmergency{drive::AxisError::following_error, 0x8611, 0,
                  error_register::kGeneric | error_register::kDeviceProfile,
                  drive::ErrorReaction::fault},
    AxisEmergency{drive::AxisError::undervoltage, 0xFF00, 0,
                  error_register::kGeneric | error_register::kVoltage, drive::ErrorReaction::fault},
    AxisEmergency{drive::AxisError::positive_software_limit, 0xFF01, 1,
                  error_register::kGeneric | error_register::kManufacturer,
                  drive::ErrorReaction::stop},
    AxisEmergency{drive::AxisError::negative_software_limit, 0xFF01, 2,
                  error_register::kGeneric | error_register::kManufacturer,
                  drive::ErrorReaction::stop},
    AxisEmergency{drive::AxisError::positive_limit_switch, 0xFF01, 3,
                  error_register::kGeneric | error_register::kManufacturer,
                  drive::ErrorReaction::stop},
    AxisEmergency{drive::AxisError::negative_limit_switch, 0xFF01, 4,
                  error_register::kGeneric | error_register::kManufacturer,
                  drive::ErrorReaction::stop},
    // Braking would feed the supply further: the motor coasts.
    AxisEmergency{drive::AxisError::overvoltage, 0x3110, 0,
                  error_register::kGeneric | error_register::kVoltage,
                  drive::ErrorReaction::power_off, false, false},
    AxisEmergency{drive::AxisError::hall_error, 0x7305, 0,
                  error_register::kGeneric | error_register::kDeviceProfile,
                  drive::ErrorReaction::fault, false, false},
    AxisEmergency{drive::AxisError::initialisation_error, 0x7305, 1,
                  error_register::kGeneric | error_register::kDeviceProfile,
                  drive::ErrorReaction::fault, false, false},
    AxisEmergency{drive::AxisError::driver_error, 0x1000, 0, error_register::kGeneric,
                  drive::ErrorReaction::power_off, false, false},
    AxisEmergency{drive::AxisError::overload, 0x1000, 0,
                  error_register::kGeneric | error_register::kCurrent,
                  drive::ErrorReaction::message, false, false},
};

/// The reactions of the table, by AxisError.
constexpr drive::ErrorReactions error_reactions() {
  drive::ErrorReactions reactions{};
  for (const AxisEmergency& row : kAxisEmergencies) {
    reactions[static_cast<std::size_t>(row.error)] = row.reaction;
  }
  return reactions;
}
static_assert(kAxisEmergencies.size() == drive::kAxisErrorCount);

}  // namespace stator::devices::tmcc160
