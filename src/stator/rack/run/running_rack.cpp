#include "stator/rack/run/running_rack.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "stator/link/ethernet/machine.hpp"
#include "stator/rack/kept/device_storage.hpp"
#include "stator/rack/observe/output_files.hpp"

namespace stator::rack {

namespace {

/// How often files are looked for that could not be written.
constexpr base::SimDuration kKeepingPeriod{100'000'000};

}  // namespace

void RunningRack::enter_thread(std::optional<unsigned> cpu) const {
  if (cpu) {
    if (const auto pinned = link::pin_this_thread(*cpu); !pinned) {
      logger->warning(pinned.error().text);
    }
  }
  if (priority) {
    if (const auto given = link::run_in_real_time(*priority); !given) {
      logger->warning(given.error().text);
    }
  }
}

void RunningRack::begin() {
  if (const base::SimDuration passed = machine_now() - reached; passed > kWorstLag) {
    set_back(passed - kWorstLag);
  }
}

base::SimTime RunningRack::present() {
  base::SimTime now = machine_now();
  if (now - reached > kOverrun) {
    now = reached + slice;
  }
  handed_out = std::max(handed_out, now);
  return handed_out;
}

// A slice never ends before the moment of the latest input, so no device has to handle input in its
// past.
RunningRack::Lag RunningRack::advance_slice() {
  if (stopping) {
    return {};  // hundreds of threads may still come for their slice
  }
  const base::SimTime begin = machine_now();
  const base::SimTime from = reached;
  const base::SimTime end = std::max(handed_out, std::min(begin, from + slice));
  rack.advance(end);
  reached = end;
  handed_out = end;
  const base::SimTime now = machine_now();
  adapt_slice(end - from, now - begin);
  lagging.store(end < begin, std::memory_order_relaxed);
  const base::SimDuration lag = now - end;
  if (lag > kWorstLag) {
    give_up(lag - kWorstLag);
  }
  const bool before = std::exchange(overrunning, lag > kOverrun);
  return {lag, overrunning && !before};
}

// A slice that took longer than kSliceTime is followed by one that should take just that; after one
// that took less than half of it slices double, so that a short hold-up of the machine is soon
// forgotten.
void RunningRack::adapt_slice(base::SimDuration simulated, base::SimDuration took) {
  if (took > kSliceTime) {
    const double part =
        static_cast<double>(kSliceTime.nanoseconds()) / static_cast<double>(took.nanoseconds());
    slice = base::SimDuration(
        static_cast<std::int64_t>(static_cast<double>(simulated.nanoseconds()) * part));
  } else if (simulated >= slice && took + took < kSliceTime) {
    slice += slice;
  }
  slice = std::clamp(slice, kShortestSlice, kLongestSlice);
}

void RunningRack::give_up(base::SimDuration time) {
  set_back(time);
  if (lost == base::SimDuration()) {
    logger->warning(fmt::format(
        "this machine is too slow for the rack: {:.0f} ms behind, its clock is set back by what "
        "exceeds {} ms, now and whenever it falls behind so far again; run fewer devices, give it "
        "processors of its own, or let the master make the time (clock = \"lockstep\")",
        static_cast<double>((time + kWorstLag).nanoseconds()) * 1e-6,
        kWorstLag.nanoseconds() / 1'000'000));
  }
  lost += time;
}

void RunningRack::keep_files() {
  if (clock_kind == ClockKind::real) {
    rack.settle_log(machine_now());
    rack.outputs().look(machine_now());
  } else if (rack.outputs().have_news()) {
    const std::scoped_lock lock(mutex);
    rack.outputs().look(lockstep_clock.now());
  }
  if (rack.storage() == nullptr) {
    return;
  }
  const std::scoped_lock lock(mutex);
  if (clock_kind == ClockKind::real && rack.storage()->busy()) {
    rack.hand_over_completions(now());
  }
  const base::SimTime moment = machine_now();
  if (moment >= next_keeping) {
    next_keeping = moment + kKeepingPeriod;
    rack.storage()->service(moment);
  }
}

void RunningRack::serve_tasks() {
  if (!tasks.waiting()) {
    return;
  }
  bool changed = false;
  {
    const std::scoped_lock lock(mutex);
    if (clock_kind == ClockKind::real) {
      catch_up();
    }
    changed = tasks.serve(rack, clock_kind == ClockKind::real ? reached : lockstep_clock.now());
  }
  if (changed) {
    tasks.wake_rack();
  }
}

void RunningRack::log_overrun(std::uint64_t count, base::SimDuration lag) const {
  logger->warning(fmt::format(
      "overrun {}: the rack was {:.1f} ms behind the machine's clock; {}", count,
      static_cast<double>(lag.nanoseconds()) * 1e-6,
      priority ? "run fewer devices"
               : "let those that answer go before the rest of the machine (--priority 50), or run "
                 "fewer devices"));
}

}  // namespace stator::rack
