#pragma once

#include <cstdint>

namespace stator::mfc::i2c {

// I2C_STATUS (L9370-L9443).
inline constexpr std::uint8_t kIdle = 0x00;
inline constexpr std::uint8_t kStarted = 0x01;
inline constexpr std::uint8_t kStartedAgain = 0x02;
inline constexpr std::uint8_t kAddress = 0x04;
inline constexpr std::uint8_t kRead = 0x08;
inline constexpr std::uint8_t kWrite = 0x10;
inline constexpr std::uint8_t kAcknowledged = 0x20;
inline constexpr std::uint8_t kNotAcknowledged = 0x40;
inline constexpr std::uint8_t kAddressError = 0xE4;
inline constexpr std::uint8_t kDataError = 0xF0;
inline constexpr std::uint8_t kGeneralError = 0xFF;

/// Steps of a byte: four per bit, of which the last of the eighth bit and the last of all concern
/// slaves and host.
inline constexpr int kStepsPerBit = 4;
inline constexpr int kLastStepOfData = 8 * kStepsPerBit - 1;
inline constexpr int kLastStepOfByte = 9 * kStepsPerBit - 1;

}  // namespace stator::mfc::i2c
