#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "ethercat/topology.hpp"

namespace stator::ethercat {

/// What can go wrong with a frame on a cable.
enum class FrameFaultKind : std::uint8_t {
  drop,     ///< it does not arrive, and no counter tells
  corrupt,  ///< bits of it are wrong, so that its check sequence fails where it arrives
};

/// A fault that hits the next `frames` frames that pass a port in one direction.
struct FrameFault {
  FrameFaultKind kind = FrameFaultKind::drop;
  SlavePort port{};
  bool leaving = false;  ///< frames that leave the slave there; false: that arrive
  unsigned frames = 1;
};

/// The faults that are still to hit frames, by the place where they show: the port at the end of
/// the cable.
class FrameFaults {
 public:
  [[nodiscard]] bool empty() const { return waiting_.empty(); }
  /// `at`: nothing for the master's end of its cables.
  void add(FrameFaultKind kind, std::optional<SlavePort> at, unsigned frames) {
    if (frames > 0) {
      waiting_.push_back({kind, at, frames});
    }
  }
  /// The fault that hits a frame arriving at `at`, once. A frame is hit by one fault at most.
  [[nodiscard]] std::optional<FrameFaultKind> hit(std::optional<SlavePort> at) {
    const auto fault = std::ranges::find(waiting_, at, &Waiting::at);
    if (fault == waiting_.end()) {
      return std::nullopt;
    }
    const FrameFaultKind kind = fault->kind;
    if (--fault->frames == 0) {
      waiting_.erase(fault);
    }
    return kind;
  }

 private:
  struct Waiting {
    FrameFaultKind kind;
    std::optional<SlavePort> at;
    unsigned frames;
  };
  std::vector<Waiting> waiting_;
};

}  // namespace stator::ethercat
