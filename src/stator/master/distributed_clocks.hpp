#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/master/bus.hpp"
#include "stator/master/slave.hpp"

namespace stator::master {

/// Receive times of one slave as latched by a write to 0900h (ETG.1000.4 §6.7.3).
struct ReceiveTimes {
  /// ns of the slave's local clock, modulo 2^32; of the ports behind the first on the way back.
  std::array<std::uint32_t, 4> ports{};
  std::uint8_t open = 1;   ///< bit n: something is connected to port n
  std::uint64_t unit = 0;  ///< local time when the frame passed the processing unit
};

/// Propagation delays in ns from the first of `slaves` to each, for a line or a tree of slaves that
/// are entered at port 0, in the order in which a frame passes them. The delay of a cable is half
/// of what the slave before it waits for the answer from that port, less what the slave behind it
/// waits for those further on.
[[nodiscard]] std::vector<std::uint32_t> propagation_delays(std::span<const ReceiveTimes> slaves);

/// Measures delays and sets delay and offset registers of all slaves with distributed clocks, so
/// that their system times equal that of the first of them, which is returned (nothing if no slave
/// has a clock). ErrorCode::configuration if the segment branches and some slave has no clock, so
/// that its place in the segment cannot be found out.
[[nodiscard]] Result<std::optional<Station>> synchronize_clocks(Bus& bus,
                                                                std::span<const Slave> slaves);

}  // namespace stator::master
