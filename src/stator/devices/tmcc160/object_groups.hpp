#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "stator/devices/tmcc160/objects.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::devices::tmcc160 {

// The objects of the TMCC160, declared once each and grouped by subject as the "TMCC160 CANopen
// Firmware Manual" (firmware V3.00) does; `source` names its lines. Where the device does not start
// with the value that is printed, or takes fewer values than the printed range, `note` says so;
// numbers A-nn are those of docs/devices/tmcc160-decisions.md.

/// 1000h-1029h: identity, SYNC, error control, emergencies, stored parameters.
void add_communication_objects(dictionary::Dictionary& dictionary, const Options& options);
/// 1400h-1403h, 1600h-1603h, 1800h-1803h, 1A00h-1A03h.
void add_pdo_objects(dictionary::Dictionary& dictionary);
/// 2010h-2060h: motor, limits, controllers, commutation.
void add_controller_objects(dictionary::Dictionary& dictionary);
/// 2005h-200Fh, 2070h-2100h: switches, measurements, position sensors, protection.
void add_sensor_objects(dictionary::Dictionary& dictionary);
/// 2702h-270Eh: inputs, bit rate and node-ID.
void add_module_objects(dictionary::Dictionary& dictionary, const Options& options);
/// 6040h-6061h, 6071h, 6077h, 607Ch, 608Fh-60B2h, 60FDh, 6502h: states, modes, torque, homing.
void add_profile_drive_objects(dictionary::Dictionary& dictionary, const Options& options);
/// 6062h-606Ch, 607Ah, 607Dh, 6081h-6085h, 60FFh: positions, velocities, ramps.
void add_profile_motion_objects(dictionary::Dictionary& dictionary, const Options& options);

// What many rows of the tables have in common.

inline constexpr dictionary::Range kSwitch{0, 1};
inline constexpr dictionary::Range kAnyInteger32{-2147483648, 2147483647};
inline constexpr dictionary::Range kAnyUnsigned8{0, 255};
inline constexpr dictionary::Range kAnyUnsigned16{0, 65535};
inline constexpr dictionary::Range kAnyUnsigned32{0, 4294967295};
inline constexpr dictionary::Range kTwelveBitRange{0, 4095};         ///< of an ADC
inline constexpr dictionary::Range kSpeedRange{0, 200000};           ///< rpm
inline constexpr dictionary::Range kVelocityRange{-200000, 200000};  ///< rpm
inline constexpr dictionary::Range kAccelerationRange{0, 100000};    ///< rpm/s
inline constexpr dictionary::Range kCurrentLimitRange{0, 90000};     ///< mA
inline constexpr dictionary::Range kCurrentRange{-90000, 90000};     ///< mA

inline constexpr std::string_view kTypeNotPrinted =
    "data type of the entry not printed (only \"Record\"); from value range and public EDS, A-43";

/// The rows as they are with Options::maps_as_maker_eds.
template <std::size_t Rows>
constexpr std::array<dictionary::EntryDeclaration, Rows> mappable(
    std::array<dictionary::EntryDeclaration, Rows> rows) {
  for (dictionary::EntryDeclaration& row : rows) {
    row.mapping = dictionary::PdoMapping::transmit;
  }
  return rows;
}

/// Subindex 0 of an array or record whose table in the document starts at subindex 1.
constexpr dictionary::EntryDeclaration highest_subindex(std::uint16_t index,
                                                        dictionary::ObjectCode code,
                                                        std::uint8_t highest, std::string_view name,
                                                        std::string_view object_name,
                                                        std::string_view source) {
  return {.index = index,
          .name = name,
          .object_code = code,
          .type = dictionary::DataType::unsigned8,
          .access = dictionary::Access::read_only,
          .default_value = highest,
          .range = dictionary::Range{highest, highest},
          .source = source,
          .note = "sub 00 not printed in the document; value = highest sub-index, A-42",
          .object_name = object_name};
}

}  // namespace stator::devices::tmcc160
