#pragma once

#include <cstddef>
#include <cstdint>

namespace stator::ethercat {

/// Addresses of registers that code reads or writes, by the names of ETG.1000.4 and the TMC8461
/// datasheet. What each register holds and allows is declared in register_table_*.cpp.
namespace register_address {

// Identification
inline constexpr std::uint16_t kType = 0x0000;
inline constexpr std::uint16_t kRevision = 0x0001;
inline constexpr std::uint16_t kBuild = 0x0002;
inline constexpr std::uint16_t kFmmusSupported = 0x0004;
inline constexpr std::uint16_t kSyncManagersSupported = 0x0005;
inline constexpr std::uint16_t kRamSize = 0x0006;
inline constexpr std::uint16_t kPortDescriptor = 0x0007;
inline constexpr std::uint16_t kFeatures = 0x0008;
inline constexpr std::uint16_t kProductId = 0x0E00;
inline constexpr std::uint16_t kVendorId = 0x0E08;

// Data link
inline constexpr std::uint16_t kStationAddress = 0x0010;
inline constexpr std::uint16_t kStationAlias = 0x0012;
inline constexpr std::uint16_t kWriteRegisterEnable = 0x0020;
inline constexpr std::uint16_t kWriteRegisterProtection = 0x0021;
inline constexpr std::uint16_t kEscWriteEnable = 0x0030;
inline constexpr std::uint16_t kEscWriteProtection = 0x0031;
inline constexpr std::uint16_t kResetByBus = 0x0040;
inline constexpr std::uint16_t kResetByHost = 0x0041;
inline constexpr std::uint16_t kDlControl = 0x0100;
inline constexpr std::uint16_t kLoopControl = 0x0101;      ///< bits 15:8 of DL control
inline constexpr std::uint16_t kReceiveFifoSize = 0x0102;  ///< bits 18:16 of DL control
inline constexpr std::uint16_t kAliasEnable = 0x0103;      ///< bit 24 of DL control
inline constexpr std::uint16_t kReadWriteOffset = 0x0108;
inline constexpr std::uint16_t kDlStatus = 0x0110;

// Application layer
inline constexpr std::uint16_t kAlControl = 0x0120;
inline constexpr std::uint16_t kAlStatus = 0x0130;
inline constexpr std::uint16_t kAlStatusCode = 0x0134;
inline constexpr std::uint16_t kRunLedOverride = 0x0138;
inline constexpr std::uint16_t kErrorLedOverride = 0x0139;
inline constexpr std::uint16_t kPdiControl = 0x0140;
inline constexpr std::uint16_t kEscConfiguration = 0x0141;
inline constexpr std::uint16_t kPdiInformation = 0x014E;
inline constexpr std::uint16_t kPdiConfiguration = 0x0150;
inline constexpr std::uint16_t kSyncLatchConfiguration = 0x0151;
inline constexpr std::uint16_t kExtendedPdiConfiguration = 0x0152;

// Events and errors
inline constexpr std::uint16_t kEcatEventMask = 0x0200;
inline constexpr std::uint16_t kAlEventMask = 0x0204;
inline constexpr std::uint16_t kEcatEventRequest = 0x0210;
inline constexpr std::uint16_t kAlEventRequest = 0x0220;
inline constexpr std::uint16_t kReceiveErrors = 0x0300;    ///< invalid frames, physical; per port
inline constexpr std::uint16_t kForwardedErrors = 0x0308;  ///< one per port
inline constexpr std::uint16_t kLastForwardedError = 0x030B;
inline constexpr std::uint16_t kProcessingUnitErrors = 0x030C;
inline constexpr std::uint16_t kPdiErrors = 0x030D;
inline constexpr std::uint16_t kPdiErrorCode = 0x030E;
inline constexpr std::uint16_t kLostLinks = 0x0310;  ///< one per port
inline constexpr std::uint16_t kLastLostLink = 0x0313;

// Watchdogs
inline constexpr std::uint16_t kWatchdogDivider = 0x0400;
inline constexpr std::uint16_t kPdiWatchdogTime = 0x0410;
inline constexpr std::uint16_t kProcessDataWatchdogTime = 0x0420;
inline constexpr std::uint16_t kProcessDataWatchdogStatus = 0x0440;
inline constexpr std::uint16_t kProcessDataWatchdogCounter = 0x0442;
inline constexpr std::uint16_t kPdiWatchdogCounter = 0x0443;

// EEPROM (SII) and PHYs (MII)
inline constexpr std::uint16_t kSiiOwner = 0x0500;
inline constexpr std::uint16_t kSiiHostAccess = 0x0501;
inline constexpr std::uint16_t kSiiControl = 0x0502;  ///< 2 bytes, commands in the second
inline constexpr std::uint16_t kSiiAddress = 0x0504;
inline constexpr std::uint16_t kSiiData = 0x0508;
inline constexpr std::uint16_t kMiiControl = 0x0510;  ///< 2 bytes, commands in the second
inline constexpr std::uint16_t kPhyAddress = 0x0512;
inline constexpr std::uint16_t kPhyRegister = 0x0513;
inline constexpr std::uint16_t kPhyData = 0x0514;
inline constexpr std::uint16_t kMiiBusAccess = 0x0516;
inline constexpr std::uint16_t kMiiHostAccess = 0x0517;
inline constexpr std::uint16_t kPhyPortStatus = 0x0518;  ///< one byte per port
inline constexpr std::uint16_t kParameterRam = 0x0580;

// FMMUs and sync managers
inline constexpr std::uint16_t kFmmus = 0x0600;
inline constexpr std::uint16_t kSyncManagers = 0x0800;

// Distributed clocks
inline constexpr std::uint16_t kReceiveTimes = 0x0900;  ///< 4 bytes per port
inline constexpr std::uint16_t kSystemTime = 0x0910;
inline constexpr std::uint16_t kReceiveTimeProcessingUnit = 0x0918;
inline constexpr std::uint16_t kSystemTimeOffset = 0x0920;
inline constexpr std::uint16_t kSystemTimeDelay = 0x0928;
inline constexpr std::uint16_t kSystemTimeDifference = 0x092C;
inline constexpr std::uint16_t kSpeedCounterStart = 0x0930;
inline constexpr std::uint16_t kSpeedCounterDifference = 0x0932;
inline constexpr std::uint16_t kDifferenceFilterDepth = 0x0934;
inline constexpr std::uint16_t kSpeedFilterDepth = 0x0935;
inline constexpr std::uint16_t kCyclicUnitControl = 0x0980;
inline constexpr std::uint16_t kSyncActivation = 0x0981;
inline constexpr std::uint16_t kSyncPulseLength = 0x0982;
inline constexpr std::uint16_t kSyncActivationStatus = 0x0984;
inline constexpr std::uint16_t kSync0Status = 0x098E;    ///< SYNC1: the next byte
inline constexpr std::uint16_t kSyncStartTime = 0x0990;  ///< read: next SYNC0 pulse
inline constexpr std::uint16_t kNextSync1Pulse = 0x0998;
inline constexpr std::uint16_t kSync0CycleTime = 0x09A0;
inline constexpr std::uint16_t kSync1CycleTime = 0x09A4;
inline constexpr std::uint16_t kLatch0Control = 0x09A8;  ///< Latch1: the next byte
inline constexpr std::uint16_t kLatch0Status = 0x09AE;   ///< Latch1: the next byte
inline constexpr std::uint16_t kLatch0PositiveEdge = 0x09B0;
inline constexpr std::uint16_t kLatch0NegativeEdge = 0x09B8;
inline constexpr std::uint16_t kLatch1PositiveEdge = 0x09C0;
inline constexpr std::uint16_t kLatch1NegativeEdge = 0x09C8;
inline constexpr std::uint16_t kEcatBufferChangeTime = 0x09F0;
inline constexpr std::uint16_t kPdiBufferStartTime = 0x09F8;
inline constexpr std::uint16_t kPdiBufferChangeTime = 0x09FC;

}  // namespace register_address

/// True if an access to `length` bytes from `address` on touches a register of `width` bytes.
constexpr bool touches(std::size_t address, std::size_t length, std::size_t register_address,
                       std::size_t width = 1) {
  return address < register_address + width && register_address < address + length;
}

}  // namespace stator::ethercat
