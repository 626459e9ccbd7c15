#include "rack/running_rack.hpp"

#include <fmt/format.h>
#include <spdlog/logger.h>

namespace stator::rack {

namespace {

/// How often changes of EEPROM and firmware are looked for.
constexpr base::SimDuration kKeepingPeriod{5'000'000};

}  // namespace

void RunningRack::keep_files() {
  if (clock_kind == ClockKind::real) {
    rack.settle_log(real_clock.now());
  }
  if (rack.storage() == nullptr) {
    return;
  }
  const std::scoped_lock lock(mutex);
  const base::SimTime present = real_clock.now();
  if (present >= next_keeping) {
    next_keeping = present + kKeepingPeriod;
    rack.storage()->service(present);
  }
}

void RunningRack::serve_desk() {
  if (!desk.waiting()) {
    return;
  }
  bool changed = false;
  {
    const std::scoped_lock lock(mutex);
    const base::SimTime present = now();
    if (clock_kind == ClockKind::real) {
      rack.advance(present);
    }
    changed = desk.serve(rack, present);
  }
  if (changed) {
    desk.wake_rack();
  }
}

void RunningRack::log_overrun(std::uint64_t count, base::SimDuration lag) const {
  logger->warn(
      "overrun {}: the rack was {:.1f} ms behind the machine's clock; run fewer devices "
      "or a less loaded machine",
      count, static_cast<double>(lag.nanoseconds()) * 1e-6);
}

}  // namespace stator::rack
