#pragma once

#include <array>
#include <cstdint>

#include "stator/canopen/storage/parameter_storage.hpp"

namespace stator::devices::tmc8670 {

// What 1010h stores and 1011h restores (CiA 301 §7.5.2.13): communication 1000h-1FFFh, application
// 6000h-9FFFh, manufacturer 2000h-5FFFh; of each what tells the drive how it is built, not what it
// shall do now.

inline constexpr auto kCommunicationParameters = std::to_array<canopen::ParameterRange>({
    {0x10F1, 0x10F1},
    {0x1600, 0x1605},
    {0x1A00, 0x1A05},
    {0x1C12, 0x1C13},
});
inline constexpr auto kApplicationParameters = std::to_array<canopen::ParameterRange>({
    {0x605A, 0x605E},
    {0x6065, 0x6068},
    {0x606D, 0x6070},
    {0x6072, 0x6073},
    {0x6075, 0x6076},
    {0x607C, 0x6087},
    {0x608F, 0x6099},
    {0x609A, 0x609A},
    {0x60C2, 0x60C2},
    {0x60D0, 0x60D0},
    {0x60F2, 0x60F2},
    {0x60FE, 0x60FE, 2},
});
inline constexpr auto kManufacturerParameters = std::to_array<canopen::ParameterRange>({
    {0x2000, 0x2013},
    {0x2014, 0x2014, 2},
    {0x2020, 0x206F},
});

inline constexpr auto kParameterGroups = std::to_array<canopen::ParameterGroup>({
    {0, kCommunicationParameters, true},
    {1, kApplicationParameters, false},
    {2, kManufacturerParameters, false},
});

inline constexpr auto kStorageCommands = std::to_array<canopen::StorageCommand>({
    {canopen::kStoreParameters, 1, canopen::StorageCommand::Action::store, 7},
    {canopen::kStoreParameters, 2, canopen::StorageCommand::Action::store, 1},
    {canopen::kStoreParameters, 3, canopen::StorageCommand::Action::store, 2},
    {canopen::kStoreParameters, 4, canopen::StorageCommand::Action::store, 4},
    {canopen::kRestoreParameters, 1, canopen::StorageCommand::Action::restore, 7},
    {canopen::kRestoreParameters, 2, canopen::StorageCommand::Action::restore, 1},
    {canopen::kRestoreParameters, 3, canopen::StorageCommand::Action::restore, 2},
    {canopen::kRestoreParameters, 4, canopen::StorageCommand::Action::restore, 4},
});

}  // namespace stator::devices::tmc8670
