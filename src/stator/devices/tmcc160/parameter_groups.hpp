#pragma once

#include <array>
#include <cstdint>

#include "stator/canopen/storage/parameter_storage.hpp"

namespace stator::devices::tmcc160 {

// Which parameters are stored and restored together (document L566-L570, L612-L616, L1405-L1406).
// The members of the motor group, and whether communication objects belong to one, the document
// leaves open; A-17 decides.

/// Numbers of the images in the non-volatile memory.
enum class Group : std::uint8_t {
  network = 0,        ///< bit rate and node-ID
  motor = 1,          ///< motor 0
  communication = 2,  ///< with Options::stores_communication_objects
  position_scale =
      3,  ///< of homing methods -5 and -6, which no object shows; not a group of objects
};

constexpr std::uint32_t bit(Group group) {
  return 1U << static_cast<unsigned>(group);
}

inline constexpr auto kNetworkParameters =
    std::to_array<canopen::ParameterRange>({{0x2704, 0x2705}});

inline constexpr auto kMotorParameters = std::to_array<canopen::ParameterRange>({
    {0x2005, 0x2005},    {0x2010, 0x2010, 1}, {0x2020, 0x2020},    {0x2025, 0x2025},
    {0x2030, 0x2030, 4}, {0x2030, 0x2030, 5}, {0x2040, 0x2040, 4}, {0x2040, 0x2040, 5},
    {0x2040, 0x2040, 6}, {0x2050, 0x2050, 4}, {0x2050, 0x2050, 6}, {0x2050, 0x2050, 7},
    {0x2055, 0x2056},    {0x2060, 0x2060, 2}, {0x2070, 0x2070, 2}, {0x2070, 0x2070, 3},
    {0x2080, 0x2080},    {0x2090, 0x2090},    {0x2095, 0x2095, 1}, {0x2095, 0x2095, 2},
    {0x605A, 0x605A},    {0x6067, 0x6067},    {0x607C, 0x607D},    {0x6081, 0x6085},
    {0x608F, 0x608F, 1}, {0x6098, 0x609A},
});

inline constexpr auto kCommunicationParameters = std::to_array<canopen::ParameterRange>({
    {0x1005, 0x1005},
    {0x100C, 0x100D},
    {0x1014, 0x1017},
    {0x1029, 0x1029},
    {0x1400, 0x1403},
    {0x1600, 0x1603},
    {0x1800, 0x1803},
    {0x1A00, 0x1A03},
});

/// With and without the last group, Options::stores_communication_objects.
inline constexpr auto kGroups = std::to_array<canopen::ParameterGroup>({
    {static_cast<std::uint8_t>(Group::network), kNetworkParameters, true},
    {static_cast<std::uint8_t>(Group::motor), kMotorParameters, false},
    {static_cast<std::uint8_t>(Group::communication), kCommunicationParameters, true},
});

constexpr auto storage_commands(bool with_communication) {
  using Action = canopen::StorageCommand::Action;
  const std::uint32_t communication =
      bit(Group::network) | (with_communication ? bit(Group::communication) : 0U);
  const std::uint32_t motor = bit(Group::motor);
  return std::to_array<canopen::StorageCommand>({
      {canopen::kStoreParameters, 1, Action::store, communication | motor},
      {canopen::kStoreParameters, 2, Action::store, communication},
      {canopen::kStoreParameters, 4, Action::store, motor},
      {canopen::kRestoreParameters, 1, Action::restore, communication | motor},
      {canopen::kRestoreParameters, 2, Action::restore, communication},
      {canopen::kRestoreParameters, 4, Action::restore, motor},
      {0x2706, 0, Action::store, bit(Group::network), 0},
  });
}

inline constexpr auto kCommands = storage_commands(false);
inline constexpr auto kCommandsWithCommunication = storage_commands(true);

}  // namespace stator::devices::tmcc160
