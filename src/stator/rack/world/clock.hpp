// Simulated time of a rack: after the machine's clock, or in lockstep with the frames of a master.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "stator/base/sim_time.hpp"
#include "stator/can/frame.hpp"
#include "stator/ethercat/standard/frame.hpp"

namespace stator::rack {

enum class ClockKind : std::uint8_t {
  real,      ///< simulated time follows the machine's clock
  lockstep,  ///< simulated time moves only with the master's frames
};

/// Simulated time that follows the machine's monotonic clock from the moment of construction on,
/// which is `start`.
class RealClock {
 public:
  explicit RealClock(base::SimTime start = {});
  [[nodiscard]] base::SimTime now() const;
  /// The time of day (CLOCK_REALTIME) at which simulated time was 0, as it was seen at
  /// construction.
  [[nodiscard]] base::SimDuration epoch() const { return epoch_; }

 private:
  std::int64_t start_;  ///< CLOCK_MONOTONIC in ns
  base::SimDuration epoch_;
};

/// Tells exchanges of process data from other frames, see LockstepClock.
class CycleRecognition {
 public:
  static constexpr int kForgetAfter = 16;
  /// The first logical datagram of a frame.
  struct Opening {
    ethercat::Command command;
    std::uint32_t address;
    friend bool operator==(const Opening&, const Opening&) = default;
  };
  /// A frame with that datagram came: true if it opens a cycle.
  [[nodiscard]] bool opens(const Opening& logical);

 private:
  std::optional<Opening> opening_;
  int frames_without_opening_ = 0;
};

/// Simulated time that moves only when the master does.
///
/// On EtherCAT each process-data exchange moves time by one bus cycle, every other frame by a small
/// step, so a test runs as fast as the machine allows and two runs with the same frames are equal.
/// A frame counts as a process-data exchange when its first logical datagram (LRD, LWR, LRW) has
/// the command and address that opened the present cycle; so a master that needs several logical
/// frames per cycle still gets one cycle. The opening datagram is learnt anew after kForgetAfter
/// logical frames without it (the master was restarted with another mapping).
class LockstepClock {
 public:
  static constexpr int kForgetAfter = CycleRecognition::kForgetAfter;
  static constexpr std::uint32_t kSyncIdentifier = 0x80;

  LockstepClock(base::SimDuration cycle, base::SimDuration step) : cycle_(cycle), step_(step) {}

  [[nodiscard]] base::SimTime now() const { return now_; }

  /// Moves time as `frame` demands and returns the moment at which it arrives.
  base::SimTime on_frame(std::span<std::byte> frame);

  /// The same for a frame that comes to a CAN bus: a SYNC (CiA 301 §7.2.5, 80h) moves time by one
  /// cycle, every other frame by the step.
  base::SimTime on_frame(const can::Frame& frame) {
    const bool sync = frame.identifier == kSyncIdentifier && !frame.extended && !frame.remote;
    return now_ += sync ? cycle_ : step_;
  }
  /// Moves on to `moment`, at which the answer to a frame comes.
  void advance_to(base::SimTime moment) { now_ = std::max(now_, moment); }

  /// What comes over a serial line moves time by the step.
  void on_telegram() { now_ += step_; }

  /// Lets `duration` pass without a frame: a master inside the process that waits.
  void wait(base::SimDuration duration) { now_ += duration; }

 private:
  static std::optional<CycleRecognition::Opening> first_logical_datagram(
      std::span<std::byte> frame);

  base::SimDuration cycle_;
  base::SimDuration step_;
  base::SimTime now_;
  CycleRecognition cycles_;
};

}  // namespace stator::rack
