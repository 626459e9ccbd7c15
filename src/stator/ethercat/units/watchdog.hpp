#pragma once

#include "stator/base/sim_time.hpp"

namespace stator::ethercat {

/// A watchdog of the slave controller: runs from one trigger to the next and expires on the clock.
/// State is a deadline, not a count of ticks, so silence costs nothing.
class Watchdog {
 public:
  /// Duration from a trigger to expiry; zero switches the watchdog off. A running watchdog restarts
  /// at `now`, as the hardware's counter is reloaded by a write to its registers.
  void set_period(base::SimDuration period, base::SimTime now) {
    period_ = period;
    if (period_ == base::SimDuration(0)) {
      deadline_ = base::SimTime::never();
      expired_ = false;
    } else if (running()) {
      deadline_ = now + period_;
    }
  }

  void trigger(base::SimTime now) {
    if (period_ != base::SimDuration(0)) {
      deadline_ = now + period_;
      expired_ = false;
    }
  }

  /// Back to "not triggered yet", in which nothing expires.
  void stop() {
    deadline_ = base::SimTime::never();
    expired_ = false;
  }

  /// True once, at the first call at or after the deadline.
  [[nodiscard]] bool expire(base::SimTime now) {
    if (now < deadline_) {
      return false;
    }
    deadline_ = base::SimTime::never();
    expired_ = true;
    return true;
  }

  [[nodiscard]] bool running() const { return deadline_ != base::SimTime::never(); }
  [[nodiscard]] bool expired() const { return expired_; }
  [[nodiscard]] base::SimTime deadline() const { return deadline_; }

 private:
  base::SimDuration period_;
  base::SimTime deadline_ = base::SimTime::never();
  bool expired_ = false;
};

}  // namespace stator::ethercat
