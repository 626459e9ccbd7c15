#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "stator/devices/tmcm_3315/objects.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::devices::tmcm_3315 {

// The objects of the TMCM-3315, declared once each and grouped by subject as the "TMCM-3315 CoE
// Firmware Manual" (firmware V1.09, document revision V1.08) does; `source` names its lines.
// Values the document leaves open are marked undocumented().

/// 1000h-1FFFh: once for the module.
void add_communication_objects(dictionary::Dictionary& dictionary, FirmwareVersion firmware);
/// 2000h-21FFh: resolution, current, brake, switches, encoder, ramp, units, monitoring.
void add_axis_motion_objects(dictionary::Dictionary& dictionary,
                             const dictionary::Placement& placement, FirmwareVersion firmware);
/// 2000h-21FFh: closed loop, chopper, CoolStep, StallGuard2, StealthChop.
void add_axis_driver_objects(dictionary::Dictionary& dictionary,
                             const dictionary::Placement& placement);
/// 2702h, 2703h, 270Eh: once for the module, outside the ranges of the axes.
void add_module_objects(dictionary::Dictionary& dictionary);
/// 6000h-67FFh: power drive state machine, modes, sensor, homing, torque, inputs.
void add_profile_drive_objects(dictionary::Dictionary& dictionary,
                               const dictionary::Placement& placement, FirmwareVersion firmware);
/// 6000h-67FFh: position, velocity, motion profile, interpolation.
void add_profile_motion_objects(dictionary::Dictionary& dictionary,
                                const dictionary::Placement& placement);

// What many rows of the tables have in common.

inline constexpr dictionary::Range kSwitch{0, 1};
inline constexpr dictionary::Range kAnyInteger8{-128, 127};
inline constexpr dictionary::Range kAnyInteger16{-32768, 32767};
inline constexpr dictionary::Range kAnyInteger32{-2147483648, 2147483647};
inline constexpr dictionary::Range kAnyUnsigned8{0, 255};
inline constexpr dictionary::Range kAnyUnsigned16{0, 65535};
inline constexpr dictionary::Range kUnsigned24{0, 16777215};
inline constexpr dictionary::Range kUnsigned31{0, 2147483647};
inline constexpr dictionary::Range kAnyUnsigned32{0, 4294967295};

inline constexpr std::string_view kVelocityUnit = "velocity unit per 208Ch (pps)";
inline constexpr std::string_view kAccelerationUnit = "acceleration unit per 208Eh (pps/s)";
inline constexpr std::string_view kCurrentUnit = "1/255 of module full-scale current";

inline constexpr std::string_view kOnlyInSwitchOnDisabled =
    "Writable only in state SWITCH ON DISABLED (document spells it SWITCHED_ON_DISABLED), readable "
    "always.";

/// Subindex 0 of an array or record whose table in the document starts at subindex 1.
constexpr dictionary::EntryDeclaration inferred_highest_subindex(std::uint16_t index,
                                                                 dictionary::ObjectCode code,
                                                                 std::uint8_t highest,
                                                                 std::string_view object_name,
                                                                 std::string_view source) {
  return {.index = index,
          .name = "Highest sub-index supported",
          .object_code = code,
          .type = dictionary::DataType::unsigned8,
          .access = dictionary::Access::constant,
          .default_value = highest,
          .range = dictionary::Range{highest, highest},
          .source = source,
          .note =
              "Sub 00 is not listed by the document; value inferred from the number of listed "
              "sub-indices.",
          .object_name = object_name};
}

}  // namespace stator::devices::tmcm_3315
