#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "master/bus.hpp"
#include "master/slave.hpp"

namespace stator::master {

/// Receive times of one slave as latched by a write to 0900h (ETG.1000.4 §6.7.3).
struct ReceiveTimes {
  std::uint32_t port0 = 0;  ///< ns of the slave's local clock, modulo 2^32
  std::uint32_t port1 = 0;  ///< on the way back; only if something is connected there
  std::uint64_t unit = 0;   ///< local time when the frame passed the processing unit
};

/// Propagation delays in ns from the first of `slaves` to each, for slaves wired in line: half of
/// the difference between the round trips behind two neighbours. Where nothing is connected behind
/// the last one, `port1` must equal `port0`.
[[nodiscard]] std::vector<std::uint32_t> propagation_delays(std::span<const ReceiveTimes> slaves);

/// Measures delays and sets delay and offset registers of all slaves with distributed clocks, so
/// that their system times equal that of the first of them, which is returned (nothing if no slave
/// has a clock). ErrorCode::configuration if the segment branches: only lines are supported.
[[nodiscard]] Result<std::optional<Station>> synchronize_clocks(Bus& bus,
                                                                std::span<const Slave> slaves);

}  // namespace stator::master
