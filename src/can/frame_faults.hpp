#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/sim_time.hpp"
#include "can/frame.hpp"

namespace stator::can {

/// What can be done to frames on their way.
enum class FrameFaultKind : std::uint8_t {
  drop,       ///< acknowledged, but nobody takes it: as if all receive buffers were full
  corrupt,    ///< a bit is destroyed: error frame, error counters, sent again
  duplicate,  ///< comes twice: as if its sender had missed the last bit of the acknowledged frame
  delay,      ///< its sender begins later
};

/// A fault that hits the next `frames` frames it applies to.
struct FrameFault {
  FrameFaultKind kind = FrameFaultKind::drop;
  unsigned frames = 1;
  std::optional<std::size_t> sender{};        ///< member of the bus; default: any
  std::optional<std::uint32_t> identifier{};  ///< default: any
  base::SimDuration delay{};                  ///< of `delay`
};

/// The faults that are still to hit a frame, in the order in which they were asked for.
class FrameFaults {
 public:
  void add(const FrameFault& fault) {
    if (fault.frames > 0) {
      waiting_.push_back(fault);
    }
  }
  [[nodiscard]] bool empty() const { return waiting_.empty(); }

  /// The fault that hits `frame` of `sender`, once. A frame is hit by one fault at most.
  [[nodiscard]] std::optional<FrameFault> hit(const Frame& frame, std::size_t sender) {
    for (auto fault = waiting_.begin(); fault != waiting_.end(); ++fault) {
      if (fault->sender.value_or(sender) == sender &&
          fault->identifier.value_or(frame.identifier) == frame.identifier) {
        const FrameFault copy = *fault;
        if (--fault->frames == 0) {
          waiting_.erase(fault);
        }
        return copy;
      }
    }
    return std::nullopt;
  }

 private:
  std::vector<FrameFault> waiting_;
};

}  // namespace stator::can
