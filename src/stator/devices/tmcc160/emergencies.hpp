#pragma once

#include <array>
#include <cstdint>

#include "stator/canopen/emergency/emergency_producer.hpp"
#include "stator/drive/axis/error_report.hpp"

namespace stator::devices::tmcc160 {

// The emergency table (document L3393-L3505). Which bits of 1001h a code sets and which errors lead
// to the Fault state the document leaves open; decide. The second additional byte is
// 255 for errors of the device and 0 for those of its motor.

inline constexpr std::uint16_t kParameterError = 0x6320;
inline constexpr std::uint16_t kCommunicationError = 0x8100;

/// Rows that services of the node raise.
inline constexpr auto kServiceEmergencies = [] {
  namespace bits = drive::error_register;
  return std::to_array<canopen::EmergencyRule>({
      {kParameterError, bits::kOfDeviceProfile, {0, 255}},
      {kCommunicationError, bits::kOfCommunication, {0, 255}},
      {0x8110, bits::kOfCommunication, {0, 255}},  // byte 1: which
      {0x8120, bits::kOfCommunication, {0, 255}},
      {0x8130, bits::kOfCommunication, {0, 255}},
      {0x8140, bits::kOfCommunication, {0, 255}},
      {0x8210, bits::kOfCommunication, {0, 255}},
      {0x8220, bits::kOfCommunication, {0, 255}},
  });
}();

/// Rows that the axis raises.
inline constexpr auto kAxisEmergencies = [] {
  using enum drive::AxisError;
  using enum drive::ErrorReaction;
  namespace bits = drive::error_register;
  return std::to_array<drive::AxisEmergency>({
      {open_load_a, 0x1000, 1, bits::kGeneric, warning},
      {open_load_b, 0x1000, 2, bits::kGeneric, warning},
      {overcurrent_high_side, 0x2310, 0, bits::kOfCurrent, power_off},
      {overcurrent_b, 0x2311, 0, bits::kOfCurrent, power_off},
      {overcurrent_a, 0x2312, 0, bits::kOfCurrent, power_off},
      // The document names two bridges. A short of the third one loads its high side.
      {overcurrent_c, 0x2310, 0, bits::kOfCurrent, power_off},
      {stall, 0x3230, 0, bits::kOfDeviceProfile, stop},
      {over_temperature_warning, 0x4310, 1, bits::kOfTemperature, warning},
      {over_temperature, 0x4310, 2, bits::kOfTemperature, power_off},
      {shutdown_switch, 0x5441, 0, bits::kOfManufacturer, power_off, true},
      {following_error, 0x8611, 0, bits::kOfDeviceProfile, fault},
      {undervoltage, 0xFF00, 0, bits::kOfVoltage, fault},
      {positive_software_limit, 0xFF01, 1, bits::kOfManufacturer, stop},
      {negative_software_limit, 0xFF01, 2, bits::kOfManufacturer, stop},
      {positive_limit_switch, 0xFF01, 3, bits::kOfManufacturer, stop},
      {negative_limit_switch, 0xFF01, 4, bits::kOfManufacturer, stop},
      // Braking would feed the supply further: the motor coasts.
      {overvoltage, 0x3110, 0, bits::kOfVoltage, power_off, false, false},
      {hall_error, 0x7305, 0, bits::kOfDeviceProfile, fault, false, false},
      {initialisation_error, 0x7305, 1, bits::kOfDeviceProfile, fault, false, false},
      {driver_error, 0x1000, 0, bits::kGeneric, power_off, false, false},
      {overload, 0x1000, 0, bits::kOfCurrent, message, false, false},
  });
}();
static_assert(kAxisEmergencies.size() == drive::kAxisErrorCount);

}  // namespace stator::devices::tmcc160
