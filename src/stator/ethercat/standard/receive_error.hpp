#pragma once

#include <cstdint>

namespace stator::ethercat {

/// Receive errors a port can count (0x0300..0x030B).
enum class ReceiveError : std::uint8_t {
  invalid_frame,    ///< wrong check sequence
  physical,         ///< the PHY reported an error
  forwarded_error,  ///< already marked as wrong by an earlier slave
};

}  // namespace stator::ethercat
