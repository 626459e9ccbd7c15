#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "stator/base/recurrence.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/can/frame.hpp"

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
  unsigned frames = 1;                        ///< 0: until it is withdrawn
  std::optional<std::size_t> sender{};        ///< member of the bus; default: any
  std::optional<std::uint32_t> identifier{};  ///< default: any
  base::SimDuration delay{};                  ///< of `delay`
  double probability = 1.0;                   ///< with which a frame is hit, 0 to 1
  std::uint64_t seed = 1;                     ///< of the choice
};

/// The faults that are still to hit a frame, in the order in which they were asked for.
class FrameFaults {
 public:
  /// Returns the fault's number.
  std::uint64_t add(const FrameFault& fault) {
    waiting_.push_back(
        {++newest_, fault, base::Recurrence(fault.frames, fault.probability, fault.seed)});
    return newest_;
  }
  void withdraw(std::uint64_t number) {
    std::erase_if(waiting_, [number](const Waiting& waiting) { return waiting.number == number; });
  }
  /// How many frames the fault has hit; nothing: it has hit all it should, or was withdrawn.
  [[nodiscard]] std::optional<std::uint64_t> hits(std::uint64_t number) const {
    const auto found = std::ranges::find(waiting_, number, &Waiting::number);
    return found == waiting_.end() ? std::nullopt : std::optional(found->recurrence.times());
  }
  [[nodiscard]] bool empty() const { return waiting_.empty(); }

  /// The fault that hits `frame` of `sender`, once. A frame is hit by one fault at most.
  [[nodiscard]] std::optional<FrameFault> hit(const Frame& frame, std::size_t sender) {
    for (auto waiting = waiting_.begin(); waiting != waiting_.end(); ++waiting) {
      const FrameFault& fault = waiting->fault;
      if (fault.sender.value_or(sender) == sender &&
          fault.identifier.value_or(frame.identifier) == frame.identifier &&
          waiting->recurrence.next()) {
        const FrameFault copy = fault;
        if (waiting->recurrence.over()) {
          waiting_.erase(waiting);
        }
        return copy;
      }
    }
    return std::nullopt;
  }

 private:
  struct Waiting {
    std::uint64_t number;
    FrameFault fault;
    base::Recurrence recurrence;
  };

  std::vector<Waiting> waiting_;
  std::uint64_t newest_ = 0;
};

}  // namespace stator::can
