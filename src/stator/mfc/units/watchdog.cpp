#include "stator/mfc/units/watchdog.hpp"

#include <algorithm>

#include "stator/mfc/units/clock.hpp"

namespace stator::mfc {

namespace {

// WD_CFG (L7682-L7732).
constexpr std::uint8_t kPersistent = 1U << 0;
constexpr std::uint8_t kPdiSelect = 1U << 1;
constexpr std::uint8_t kMfcSelect = 1U << 2;
constexpr std::uint8_t kStartOfFrame = 1U << 3;
constexpr std::uint8_t kInputEdge = 1U << 4;
constexpr std::uint8_t kActive = 1U << 7;

constexpr std::uint32_t levels_of(std::uint64_t mask_and_levels) {
  return static_cast<std::uint32_t>(mask_and_levels) & Watchdog::kLines;
}
constexpr std::uint32_t mask_of(std::uint64_t mask_and_levels) {
  return static_cast<std::uint32_t>(mask_and_levels >> 32) & Watchdog::kLines;
}

}  // namespace

std::uint32_t Watchdog::counter() const {
  if (time_ == 0) {
    return 0;
  }
  return expired_ ? time_ : static_cast<std::uint32_t>(Clock25MHz::last_tick(now_) - started_);
}

std::uint32_t Watchdog::peak() const {
  return std::max(peak_, counter());
}

std::uint8_t Watchdog::configuration() const {
  return static_cast<std::uint8_t>(configuration_ | (expired_ ? kActive : 0));
}

void Watchdog::advance(base::SimTime to, SignalSink& sink) {
  const base::SimTime expiry = next_event();
  now_ = to;
  if (expiry <= to) {
    expired_ = true;
    sink.interrupt(expiry, IrqSource::mfc_watchdog_timeout);
  }
}

base::SimTime Watchdog::next_event() const {
  return time_ == 0 || expired_ ? base::SimTime::never() : Clock25MHz::time_of(started_ + time_);
}

void Watchdog::write_time(std::uint32_t time) {
  time_ = time;
  started_ = Clock25MHz::last_tick(now_);
  peak_ = 0;
  expired_ = false;
}

void Watchdog::retrigger() {
  if (expired_ && (configuration_ & kPersistent) != 0) {
    return;
  }
  peak_ = peak();
  started_ = Clock25MHz::last_tick(now_);
  expired_ = false;
}

void Watchdog::trigger(WatchdogTrigger trigger) {
  std::uint8_t enable = kStartOfFrame;
  if (trigger == WatchdogTrigger::pdi_select) {
    enable = kPdiSelect;
  } else if (trigger == WatchdogTrigger::mfc_select) {
    enable = kMfcSelect;
  }
  if ((configuration_ & enable) != 0) {
    retrigger();
  }
}

bool Watchdog::condition() const {
  // With no line selected it never changes, so it never triggers.
  return ((lines_ ^ levels_of(inputs_)) & mask_of(inputs_)) == 0;
}

void Watchdog::set_lines(std::uint32_t levels) {
  const bool before = condition();
  lines_ = levels & kLines;
  const bool edge =
      (configuration_ & kInputEdge) != 0 ? !before && condition() : before && !condition();
  if (edge) {
    retrigger();
  }
}

WatchdogAction Watchdog::action() const {
  if (!expired_) {
    return {};
  }
  return {.active = true,
          .lines = mask_of(outputs_),
          .levels = levels_of(outputs_),
          .enables = enables_ & kLines};
}

}  // namespace stator::mfc
