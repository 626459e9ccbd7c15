#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stator/can/port.hpp"
#include "stator/ethercat/segment/topology.hpp"

namespace stator::replay {

/// "01 A0 FF".
[[nodiscard]] std::string to_hex(std::span<const std::byte> bytes);

/// "601h [8] 40 41 60 00 00 00 00 00 at 1.250000000 s".
[[nodiscard]] std::string to_text(const can::TimedFrame& frame);

/// A frame as it left; no exit: it got lost.
struct LeavingFrame {
  std::optional<ethercat::MasterInterface> exit;
  std::span<const std::byte> frame;
};

/// What distinguishes two frames that should be equal, of each: the first datagram that differs,
/// with command, address, data and working counter.
[[nodiscard]] std::pair<std::string, std::string> explain_frames(const LeavingFrame& expected,
                                                                 const LeavingFrame& got);

}  // namespace stator::replay
