#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/drive/axis/axis_error.hpp"

namespace stator::devices::tmcm_3315 {

/// Bits of the error register 1001h (document L418-L427).
namespace error_register {
inline constexpr std::uint8_t kGeneric = 1U << 0;
inline constexpr std::uint8_t kCurrent = 1U << 1;
inline constexpr std::uint8_t kVoltage = 1U << 2;
inline constexpr std::uint8_t kTemperature = 1U << 3;
inline constexpr std::uint8_t kDeviceProfile = 1U << 5;
inline constexpr std::uint8_t kManufacturer = 1U << 7;
}  // namespace error_register

/// One row of the emergency table (document L3756-L3779). Which bits of 1001h a code sets and which
/// errors lead to the Fault state the document leaves open; this table decides.
struct Emergency {
  std::uint16_t code = 0;
  std::uint8_t detail = 0;  ///< first additional byte
  std::uint8_t register_bits = 0;
};

struct AxisEmergency {
  drive::AxisError error{};
  Emergency emergency;
  drive::ErrorReaction reaction{};
  bool whole_module = false;  ///< told once for all axes, with motor number 255
};

inline constexpr Emergency kFaultReset{0x0000, 0, 0};
inline constexpr Emergency kParameterError{
    0x6320, 0, error_register::kGeneric | error_register::kDeviceProfile};

inline constexpr std::array kAxisEmergencies{
    AxisEmergency{drive::AxisError::following_error,
                  {0x8611, 0, error_register::kGeneric | error_register::kDeviceProfile},
                  drive::ErrorReaction::fault},
    AxisEmergency{drive::AxisError::positive_software_limit,
                  {0xFF01, 1, error_register::kGeneric | error_register::kManufacturer},
                  drive::ErrorReaction::stop},
    AxisEmergency{drive::AxisError::negative_software_limit,
                  {0xFF01, 2, error_register::kGeneric | error_register::kManufacturer},
                  drive::ErrorReaction::stop},
    AxisEmergency{drive::AxisError::positive_limit_switch,
                  {0xFF01, 3, error_register::kGeneric | error_register::kManufacturer},
                  drive::ErrorReaction::stop},
    AxisEmergency{drive::AxisError::negative_limit_switch,
                  {0xFF01, 4, error_register::kGeneric | error_register::kManufacturer},
                  drive::ErrorReaction::stop},
    AxisEmergency{drive::AxisError::open_load_a,
                  {0x1000, 1, error_register::kGeneric},
                  drive::ErrorReaction::warning},
    AxisEmergency{drive::AxisError::open_load_b,
                  {0x1000, 2, error_register::kGeneric},
                  drive::ErrorReaction::warning},
    AxisEmergency{drive::AxisError::overcurrent_high_side,
                  {0x2310, 0, error_register::kGeneric | error_register::kCurrent},
                  drive::ErrorReaction::power_off},
    AxisEmergency{drive::AxisError::overcurrent_b,
                  {0x2311, 0, error_register::kGeneric | error_register::kCurrent},
                  drive::ErrorReaction::power_off},
    AxisEmergency{drive::AxisError::overcurrent_a,
                  {0x2312, 0, error_register::kGeneric | error_register::kCurrent},
                  drive::ErrorReaction::power_off},
    AxisEmergency{drive::AxisError::stall,
                  {0x3230, 0, error_register::kGeneric | error_register::kDeviceProfile},
                  drive::ErrorReaction::stop},
    AxisEmergency{drive::AxisError::over_temperature_warning,
                  {0x4310, 1, error_register::kGeneric | error_register::kTemperature},
                  drive::ErrorReaction::warning},
    AxisEmergency{drive::AxisError::over_temperature,
                  {0x4310, 2, error_register::kGeneric | error_register::kTemperature},
                  drive::ErrorReaction::power_off},
    AxisEmergency{drive::AxisError::shutdown_switch,
                  {0x5441, 0, error_register::kGeneric | error_register::kManufacturer},
                  drive::ErrorReaction::power_off,
                  true},
    AxisEmergency{drive::AxisError::undervoltage,
                  {0xFF00, 0, error_register::kGeneric | error_register::kVoltage},
                  drive::ErrorReaction::power_off},
};

/// The reactions of the table, by AxisError.
constexpr drive::ErrorReactions error_reactions() {
  drive::ErrorReactions reactions{};
  for (const AxisEmergency& row : kAxisEmergencies) {
    reactions[static_cast<std::size_t>(row.error)] = row.reaction;
  }
  return reactions;
}
static_assert(kAxisEmergencies.size() == drive::kStepperErrorCount);

}  // namespace stator::devices::tmcm_3315
