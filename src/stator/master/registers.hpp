#pragma once

#include <cstdint>

// Registers of an EtherCAT slave controller that the master uses (ETG.1000.4 §6).
namespace stator::master::registers {

inline constexpr std::uint16_t kInformation = 0x0000;  ///< type, revision, FMMU and SM count ...
inline constexpr std::uint16_t kStationAddress = 0x0010;
inline constexpr std::uint16_t kDlControlLoops = 0x0101;
inline constexpr std::uint16_t kDlStatus = 0x0110;
inline constexpr std::uint16_t kAlControl = 0x0120;
inline constexpr std::uint16_t kAlStatus = 0x0130;          ///< status, reserved, code at 0x0134
inline constexpr std::uint16_t kEscConfiguration = 0x0141;  ///< bit 0: device emulation
inline constexpr std::uint16_t kEcatEventMask = 0x0200;
inline constexpr std::uint16_t kReceiveErrors = 0x0300;
inline constexpr std::uint16_t kSiiOwner = 0x0500;
inline constexpr std::uint16_t kSiiControl = 0x0502;
inline constexpr std::uint16_t kSiiData = 0x0508;
inline constexpr std::uint16_t kFmmu = 0x0600;
inline constexpr std::uint16_t kFmmuSize = 16;
inline constexpr std::uint16_t kSyncManager = 0x0800;
inline constexpr std::uint16_t kSyncManagerSize = 8;
inline constexpr std::uint16_t kReceiveTimes = 0x0900;  ///< of ports 0 to 3
inline constexpr std::uint16_t kSystemTime = 0x0910;
inline constexpr std::uint16_t kReceiveTimeUnit = 0x0918;  ///< local time at the processing unit
inline constexpr std::uint16_t kSystemTimeOffset = 0x0920;
inline constexpr std::uint16_t kSystemTimeDelay = 0x0928;
inline constexpr std::uint16_t kSpeedCounterStart = 0x0930;
inline constexpr std::uint16_t kSyncActivation = 0x0981;

/// Register `offset` of sync manager `channel`.
constexpr std::uint16_t sync_manager(unsigned channel, std::uint16_t offset) {
  return static_cast<std::uint16_t>(kSyncManager + channel * kSyncManagerSize + offset);
}
inline constexpr std::uint16_t kSyncManagerStatus = 5;
inline constexpr std::uint16_t kSyncManagerActivate = 6;
inline constexpr std::uint16_t kSyncManagerHostControl = 7;
inline constexpr std::uint8_t kMailboxFull = 0x08;    ///< in the status
inline constexpr std::uint8_t kRepeatRequest = 0x02;  ///< in activate; host control acknowledges

}  // namespace stator::master::registers
