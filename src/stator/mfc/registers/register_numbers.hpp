#pragma once

#include <cstdint>

/// Numbers of the multi-function I/O block's registers (TMC8461 datasheet L6295-L6441).
namespace stator::mfc::register_number {

inline constexpr std::uint8_t kEncMode = 0;
inline constexpr std::uint8_t kEncStatus = 1;
inline constexpr std::uint8_t kPositionWrite = 2;
inline constexpr std::uint8_t kPositionRead = 3;
inline constexpr std::uint8_t kEncConst = 4;
inline constexpr std::uint8_t kEncLatch = 5;
inline constexpr std::uint8_t kSpiRxData = 6;
inline constexpr std::uint8_t kSpiTxData = 7;
inline constexpr std::uint8_t kSpiConf = 8;
inline constexpr std::uint8_t kSpiStatus = 9;
inline constexpr std::uint8_t kSpiLength = 10;
inline constexpr std::uint8_t kSpiTime = 11;
inline constexpr std::uint8_t kI2cTimebase = 12;
inline constexpr std::uint8_t kI2cControl = 13;
inline constexpr std::uint8_t kI2cStatus = 14;
inline constexpr std::uint8_t kI2cAddress = 15;
inline constexpr std::uint8_t kI2cDataR = 16;
inline constexpr std::uint8_t kI2cDataW = 17;
inline constexpr std::uint8_t kSdCh0Steprate = 18;
inline constexpr std::uint8_t kSdCh1Steprate = 19;
inline constexpr std::uint8_t kSdCh2Steprate = 20;
inline constexpr std::uint8_t kSdCh0Stepcount = 21;
inline constexpr std::uint8_t kSdCh1Stepcount = 22;
inline constexpr std::uint8_t kSdCh2Stepcount = 23;
inline constexpr std::uint8_t kSdCh0Steptarget = 24;
inline constexpr std::uint8_t kSdCh1Steptarget = 25;
inline constexpr std::uint8_t kSdCh2Steptarget = 26;
inline constexpr std::uint8_t kSdCh0Compare = 27;
inline constexpr std::uint8_t kSdCh1Compare = 28;
inline constexpr std::uint8_t kSdCh2Compare = 29;
inline constexpr std::uint8_t kSdCh0Nextsr = 30;
inline constexpr std::uint8_t kSdCh1Nextsr = 31;
inline constexpr std::uint8_t kSdCh2Nextsr = 32;
inline constexpr std::uint8_t kSdSteplength = 33;
inline constexpr std::uint8_t kSdDelay = 34;
inline constexpr std::uint8_t kSdCfg = 35;
inline constexpr std::uint8_t kPwmCfg = 36;
inline constexpr std::uint8_t kPwm1 = 37;
inline constexpr std::uint8_t kPwm2 = 38;
inline constexpr std::uint8_t kPwm3 = 39;
inline constexpr std::uint8_t kPwm4 = 40;
inline constexpr std::uint8_t kPwm1Cntrshft = 41;
inline constexpr std::uint8_t kPwm2Cntrshft = 42;
inline constexpr std::uint8_t kPwm3Cntrshft = 43;
inline constexpr std::uint8_t kPwm4Cntrshft = 44;
inline constexpr std::uint8_t kPwmPulseBPulseA = 45;
inline constexpr std::uint8_t kPwmPulseLength = 46;
inline constexpr std::uint8_t kGpo = 47;
inline constexpr std::uint8_t kGpi = 48;
inline constexpr std::uint8_t kGpioConfig = 49;
inline constexpr std::uint8_t kDacVal = 50;
inline constexpr std::uint8_t kMfcioIrqCfg = 51;
inline constexpr std::uint8_t kMfcioIrqFlags = 52;
inline constexpr std::uint8_t kWdTime = 53;
inline constexpr std::uint8_t kWdCfg = 54;
inline constexpr std::uint8_t kWdOutMaskPol = 55;
inline constexpr std::uint8_t kWdOePol = 56;
inline constexpr std::uint8_t kWdInMaskPol = 57;
inline constexpr std::uint8_t kWdMax = 58;
inline constexpr std::uint8_t kHvAnaStatus = 59;
inline constexpr std::uint8_t kSyncEventCount = 63;
inline constexpr std::uint8_t kHvioCfg = 64;
inline constexpr std::uint8_t kBuckConvCfg = 65;
inline constexpr std::uint8_t kAlOverride = 66;

}  // namespace stator::mfc::register_number
