#pragma once

#include <array>
#include <cstdint>

namespace stator::canopen::lss {

/// Identifiers of the layer setting services (CiA 305 §6.2).
inline constexpr std::uint32_t kMasterIdentifier = 0x7E5;
inline constexpr std::uint32_t kSlaveIdentifier = 0x7E4;

/// Command specifiers (CiA 305 §6.3).
enum class Command : std::uint8_t {
  switch_global = 4,
  configure_node_id = 17,
  configure_bit_timing = 19,
  activate_bit_timing = 21,
  store_configuration = 23,
  switch_selective_vendor = 64,
  switch_selective_product = 65,
  switch_selective_revision = 66,
  switch_selective_serial = 67,
  switch_selective_response = 68,
  identify_vendor = 70,
  identify_product = 71,
  identify_revision_low = 72,
  identify_revision_high = 73,
  identify_serial_low = 74,
  identify_serial_high = 75,
  identify_non_configured = 76,
  identify_response = 79,
  identify_non_configured_response = 80,
  fastscan = 81,
  inquire_vendor = 90,
  inquire_product = 91,
  inquire_revision = 92,
  inquire_serial = 93,
  inquire_node_id = 94,
};

// Error codes of the configuration services.
inline constexpr std::uint8_t kSuccess = 0;
inline constexpr std::uint8_t kNodeIdOutOfRange = 1;     ///< configure node-ID
inline constexpr std::uint8_t kBitRateNotSupported = 1;  ///< configure bit timing
inline constexpr std::uint8_t kStoringNotSupported = 1;  ///< store configuration
inline constexpr std::uint8_t kStorageAccessError = 2;   ///< store configuration

/// Bit rates of the standard table (selector 0) by index, bit/s; 0 where it is reserved.
inline constexpr std::array<std::uint32_t, 9> kBitRates{
    1'000'000, 800'000, 500'000, 250'000, 125'000, 0, 50'000, 20'000, 10'000};

/// "Bit check" of fastscan that asks whether anybody is there, and resets the scan.
inline constexpr std::uint8_t kFastscanReset = 128;

}  // namespace stator::canopen::lss
