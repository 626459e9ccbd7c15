// The event raised when a program sets another bit rate at a CAN port than that of the bus.
#pragma once

#include "stator/base/event.hpp"
#include "stator/link/can/can_link.hpp"

namespace stator::link {

inline constexpr base::EventRule kBitRateDiffers{
    "can-bit-rate-differs", base::Severity::warning,
    "a program set {0:d3} kbit/s at \"{1}\", but the bus runs at {2} kbit/s; on a cable neither "
    "would understand the other: give both the same bit rate (here it is ignored)"};

/// Tells the person when a program asks for another bit rate than the bus has; `bit_rate` in bit/s.
inline void report_bit_rate(const CanLink& link, const CanLinkOptions& options, base::SimTime now,
                            unsigned bit_rate) {
  if (options.bit_rate != 0 && options.bit_rate * 1'000 != bit_rate) {
    options.reporter.report(
        now, kBitRateDiffers,
        {bit_rate, base::SharedText(std::string(link.name())), options.bit_rate});
  }
}

}  // namespace stator::link
