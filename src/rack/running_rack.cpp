#include "rack/running_rack.hpp"

#include <fmt/format.h>
#include <spdlog/logger.h>

#include "link/machine.hpp"

namespace stator::rack {

namespace {

/// How often changes of EEPROM and firmware are looked for.
constexpr base::SimDuration kKeepingPeriod{5'000'000};

}  // namespace

void RunningRack::enter_thread(std::optional<unsigned> cpu) const {
  if (cpu) {
    if (const auto pinned = link::pin_this_thread(*cpu); !pinned) {
      logger->warn("{}", pinned.error().text);
    }
  }
  if (priority) {
    if (const auto given = link::run_in_real_time(*priority); !given) {
      logger->warn("{}", given.error().text);
    }
  }
}

void RunningRack::keep_files() {
  if (clock_kind == ClockKind::real) {
    rack.settle_log(real_clock.now());
    rack.outputs().look(real_clock.now());
  } else if (rack.outputs().have_news()) {
    const std::scoped_lock lock(mutex);
    rack.outputs().look(lockstep_clock.now());
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
      "overrun {}: the rack was {:.1f} ms behind the machine's clock; {}", count,
      static_cast<double>(lag.nanoseconds()) * 1e-6,
      priority ? "run fewer devices"
               : "let those that answer go before the rest of the machine (--priority 50), or run "
                 "fewer devices");
}

}  // namespace stator::rack
