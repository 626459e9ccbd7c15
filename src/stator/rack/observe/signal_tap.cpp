#include "stator/rack/observe/signal_tap.hpp"

#include <stdexcept>
#include <utility>

namespace stator::rack {

SignalTap::SignalTap(std::vector<product::Signal> signals, base::SimDuration period,
                     std::size_t capacity)
    : signals_(std::move(signals)),
      period_(period),
      times_(capacity),
      values_(capacity * signals_.size()) {
  if (period <= base::SimDuration(0) || capacity == 0) {
    throw std::logic_error("a tap needs a period and room");
  }
}

void SignalTap::begin(base::SimTime now) {
  const base::SimDuration into_period = now.since_power_on() % period_;
  next_sample_ = into_period == base::SimDuration(0) ? now : now + (period_ - into_period);
}

void SignalTap::sample(base::SimTime now) {
  next_sample_ = now + period_;
  const std::size_t written = written_.load(std::memory_order_relaxed);
  if (written - read_.load(std::memory_order_acquire) == times_.size()) {
    lost_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  const std::size_t at = written % times_.size();
  times_[at] = now;
  double* value = values_.data() + at * signals_.size();
  for (const product::Signal& signal : signals_) {
    *value++ = signal.read();
  }
  written_.store(written + 1, std::memory_order_release);
}

}  // namespace stator::rack
