#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "drive/axis_error.hpp"

namespace stator::devices::tmcm_3315 {

/// Bits of the error register 1001h (document L418-L427).
namespace error_register {
inline constexpr std::uint8_t kGeneric = 1U << 0;
inline constexpr std::uint8_t kDeviceProfile = 1U << 5;
inline constexpr std::uint8_t kManufacturer = 1U << 7;
}  // namespace error_register

/// One row of the emergency table (document L3756-L3779). Which bits of 1001h a code sets and which
/// errors lead to the Fault state the document leaves open; this table decides.
struct Emergency {
  std::uint16_t code;
  std::uint8_t detail;  ///< first additional byte
  std::uint8_t register_bits;
};

struct AxisEmergency {
  drive::AxisError error;
  Emergency emergency;
  drive::ErrorReaction reaction;
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

}  // namespace stator::devices::tmcm_3315
