#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "stator/dictionary/declaration.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::devices::tmc8670 {

// The parts add_objects() puts together. The chip's document names its firmware's CoE stack and
// drive profile and not one object, so every row comes from a standard or is a proposal;
// each says which. tests/data/tmc8670/objects_recommended.csv is what they are compared with.

/// 1000h-1FFFh without PDOs: identity, storage, error settings, sync managers.
void add_communication_objects(dictionary::Dictionary& dictionary);
/// 1600h.., 1A00h.., 1C12h, 1C13h: what process data carry.
void add_pdo_objects(dictionary::Dictionary& dictionary);
/// 6000h-6079h and 60FDh-6502h: power state machine, modes, position, velocity, torque, pins.
void add_profile_drive_objects(dictionary::Dictionary& dictionary);
/// 607Ah-60FCh: targets, limits, motion profile, homing, touch probe, interpolation.
void add_profile_motion_objects(dictionary::Dictionary& dictionary);
/// 2000h-204Fh: parameters of the FOC block that the document names.
void add_foc_objects(dictionary::Dictionary& dictionary);
/// 2050h-2FFFh: what the firmware needs beyond them.
void add_firmware_objects(dictionary::Dictionary& dictionary);

inline constexpr std::string_view kNotInDocument = "not in document";
inline constexpr std::string_view kCommunication = "CiA 301 / ETG.1000.6";
inline constexpr std::string_view kProfile = "CiA 402 / IEC 61800-7-201";
inline constexpr std::string_view kEtg1020 = "ETG.1020";
inline constexpr std::string_view kRecommended = "ETG.1020; recommended";
/// Of objects of this project's own.
inline constexpr std::string_view kVendor = "vendor object of the virtual device";
inline constexpr std::int64_t kLowest32 = -2147483648;

/// Every value of an integer type.
constexpr dictionary::Range full_range(dictionary::DataType type) {
  using enum dictionary::DataType;
  switch (type) {
    case integer8:
      return {-128, 127};
    case integer16:
      return {-32768, 32767};
    case integer32:
      return {kLowest32, 2147483647};
    case unsigned8:
      return {0, 255};
    case unsigned16:
      return {0, 65535};
    default:
      return {0, 4294967295};
  }
}

/// A row of the tables, in the order of their columns.
constexpr dictionary::EntryDeclaration entry(std::uint16_t index, std::uint8_t subindex,
                                             std::string_view name, dictionary::ObjectCode code,
                                             dictionary::DataType type, dictionary::Access access,
                                             dictionary::PdoMapping mapping,
                                             dictionary::Default default_value,
                                             std::string_view unit, std::string_view note) {
  dictionary::EntryDeclaration row{.index = index,
                                   .subindex = subindex,
                                   .name = name,
                                   .object_code = code,
                                   .type = type,
                                   .access = access,
                                   .mapping = mapping,
                                   .default_value = default_value,
                                   .unit = unit,
                                   .source = kNotInDocument,
                                   .note = note};
  if (type != dictionary::DataType::visible_string) {
    row.range = full_range(type);
  }
  return row;
}

/// Subindex 0 of an array or record called `title`.
constexpr dictionary::EntryDeclaration titled(std::string_view title,
                                              dictionary::EntryDeclaration row) {
  row.object_name = title;
  return row;
}

/// A row that takes some values only.
constexpr dictionary::EntryDeclaration one_of(base::StaticList values,
                                              dictionary::EntryDeclaration row) {
  row.legal_values = values;
  return row;
}

/// A row that takes a part of its type's values only.
constexpr dictionary::EntryDeclaration within(dictionary::Range range,
                                              dictionary::EntryDeclaration row) {
  row.range = range;
  return row;
}

/// A row that shows the world or the running firmware.
constexpr dictionary::EntryDeclaration live(dictionary::EntryDeclaration row) {
  row.live = true;
  return row;
}

/// A row that is written in Pre-Operational only.
constexpr dictionary::EntryDeclaration configured(dictionary::EntryDeclaration row) {
  row.write_states = dictionary::kPreOperationalOnly;
  return row;
}

}  // namespace stator::devices::tmc8670
