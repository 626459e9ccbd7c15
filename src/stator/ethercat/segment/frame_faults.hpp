#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/recurrence.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/ethercat/segment/topology.hpp"
#include "stator/ethercat/standard/frame.hpp"

namespace stator::ethercat {

/// What can go wrong with a frame on a cable.
enum class FrameFaultKind : std::uint8_t {
  drop,       ///< it does not arrive, and no counter tells
  corrupt,    ///< bits of it are wrong, so that its check sequence fails where it arrives
  delay,      ///< it arrives later, and what is behind the place processes it later
  duplicate,  ///< a copy follows it, which what is behind the place processes as well
  reorder,    ///< it arrives after the frame that follows it
};

/// A fault that hits frames that pass a port in one direction.
struct FrameFault {
  FrameFaultKind kind = FrameFaultKind::drop;
  SlavePort port{};
  bool leaving = false;       ///< frames that leave the slave there; false: that arrive
  unsigned frames = 1;        ///< 0: until it is withdrawn
  base::SimDuration delay{};  ///< of `delay`; of `reorder`: how long it waits for another frame
  double probability = 1.0;   ///< with which a frame is hit, 0 to 1
  std::uint64_t seed = 1;     ///< of the choice
};

/// The faults that are to hit frames, by the place where they show: the port at the end of the
/// cable.
class FrameFaults {
 public:
  [[nodiscard]] bool empty() const { return waiting_.empty(); }
  /// `at`: nothing for the master's end of its cables. Returns the fault's number.
  std::uint64_t add(const FrameFault& fault, std::optional<SlavePort> at) {
    waiting_.push_back(
        {++newest_, fault, at, base::Recurrence(fault.frames, fault.probability, fault.seed)});
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
  /// The fault that hits a frame arriving at `at`. A frame is hit by one fault at most.
  [[nodiscard]] std::optional<FrameFault> hit(std::optional<SlavePort> at) {
    for (auto fault = waiting_.begin(); fault != waiting_.end(); ++fault) {
      if (fault->at == at && fault->recurrence.next()) {
        const FrameFault copy = fault->fault;
        if (fault->recurrence.over()) {
          waiting_.erase(fault);
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
    std::optional<SlavePort> at;
    base::Recurrence recurrence;
  };

  std::vector<Waiting> waiting_;
  std::uint64_t newest_ = 0;
};

/// A slave executes datagrams but does not count them in their working counters.
struct CountFault {
  std::size_t slave = 0;       ///< in the order in which slaves were added
  std::uint16_t commands = 0;  ///< bit n: Command n
  unsigned datagrams = 1;      ///< 0: until it is withdrawn
  double probability = 1.0;    ///< with which a datagram is hit, 0 to 1
  std::uint64_t seed = 1;
};

/// A frame on its way that waits on a cable.
struct HeldFrame {
  std::array<std::byte, kMaximumFrameLength> bytes{};
  std::size_t length = 0;
  MasterInterface entry = MasterInterface::primary;
  std::size_t passed = 0;  ///< processing units behind it
  base::SimTime sent;      ///< as if by the master, for the times at which it goes on
  base::SimTime release;   ///< when it goes on
  bool overtaken = false;  ///< it goes on behind the next frame, if that comes before `release`
  std::uint64_t plan = 0;  ///< number of the plan of ways it follows
};

/// Gets every frame of a segment after the slaves have processed it, e.g. to find the frame at
/// which a fault begins.
class FrameObserver {
 public:
  FrameObserver() = default;
  FrameObserver(const FrameObserver&) = delete;
  FrameObserver& operator=(const FrameObserver&) = delete;
  virtual ~FrameObserver() = default;

  /// `answered`: the frame comes back to the master, with these datagrams.
  virtual void frame_passed(std::span<const DatagramView> datagrams, bool answered,
                            base::SimTime arrival) = 0;
};

}  // namespace stator::ethercat
