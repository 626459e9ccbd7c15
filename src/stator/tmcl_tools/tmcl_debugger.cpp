#include "stator/tmcl_tools/tmcl_debugger.hpp"

#include <algorithm>
#include <utility>

namespace stator::tmcl_tools {

namespace {

/// How far time goes at once where nothing happens. With watchpoints, as often as motors move.
constexpr base::SimDuration kStride{10'000'000};
constexpr base::SimDuration kWatchfulStride{100'000};
constexpr unsigned kStridesBetweenLooks = 64;

}  // namespace

TmclDebugger::TmclDebugger(MakeTmclModule make_module, TmclSource source,
                           std::vector<InputChange> changes)
    : make_module_(std::move(make_module)),
      source_(std::move(source)),
      changes_(std::move(changes)) {
  restart();
}

void TmclDebugger::restart() {
  values_.reset();
  bench_ = std::make_unique<TmclBench>(make_module_());
  values_ = std::make_unique<TmclDebugValues>(*bench_, source_);
  bench_->observe(*this);
  for (const InputChange& change : changes_) {
    if (change.time == base::SimTime()) {
      bench_->set_input(change.input, change.value);
    } else {
      bench_->schedule(change);
    }
  }
  last_step_ = {};
  for (StopPoint& point : stop_points_) {
    point.hits = 0;
    if (!point.expression.empty()) {
      point.value = values_->evaluate(point.expression).has_value()
                        ? *values_->evaluate(point.expression)
                        : 0;
    }
  }
  bench_->start(source_.program().instructions);
}

void TmclDebugger::executed(const tmcl::ProgramStep& step, const tmcl::Registers& /*registers*/) {
  last_step_ = step;
}

Stop TmclDebugger::run_until(const Reached& reached, base::SimTime limit) {
  if (!bench_->running()) {
    return {.cause = StopCause::ended};
  }
  std::uint64_t before = bench_->executed();
  for (unsigned strides = 1;; ++strides) {
    const base::SimDuration stride = watches() ? kWatchfulStride : kStride;
    if (!bench_->advance_to_next(std::min(limit, bench_->now() + stride))) {
      return {.cause = StopCause::time_up};
    }
    const bool executed = bench_->executed() != before;
    before = bench_->executed();
    if (const auto stop = changed_watchpoint()) {
      return *stop;
    }
    if (executed && stop_on_refusal_ && last_step_.status != tmcl::Status::success) {
      return {.cause = StopCause::refused};
    }
    if (!bench_->running()) {
      return {.cause = StopCause::ended};
    }
    if (executed) {
      if (const auto stop = hit_breakpoint()) {
        return *stop;
      }
      if (reached()) {
        return {.cause = StopCause::place_reached};
      }
    }
    if (strides % kStridesBetweenLooks == 0 && interrupted_ && interrupted_()) {
      return {.cause = StopCause::interrupted};
    }
  }
}

Stop TmclDebugger::repeat(std::uint64_t count, const std::function<Stop()>& once) {
  Stop stop;
  for (std::uint64_t i = 0; i < count && stop.cause == StopCause::place_reached; ++i) {
    stop = once();
  }
  return stop;
}

Stop TmclDebugger::run() {
  restart();
  const auto stop = hit_breakpoint();
  return stop ? *stop : resume();
}

Stop TmclDebugger::step(std::uint64_t count) {
  return repeat(count, [this] { return run_until([] { return true; }); });
}

Stop TmclDebugger::next(std::uint64_t count) {
  return repeat(count, [this] {
    return run_until([this, depth = depth()] { return this->depth() <= depth; });
  });
}

Stop TmclDebugger::finish() {
  return run_until([this, depth = depth()] { return this->depth() < depth; });
}

Stop TmclDebugger::until_below() {
  return run_until([this, depth = depth(), address = address()] {
    return this->depth() < depth || (this->depth() == depth && this->address() > address);
  });
}

Stop TmclDebugger::until(std::size_t address) {
  return run_until([this, address] { return this->address() == address; });
}

Stop TmclDebugger::resume(base::SimTime limit) {
  return run_until([] { return false; }, limit);
}

Stop TmclDebugger::jump(std::size_t address) {
  bench_->firmware().interpreter().run_from(static_cast<std::uint16_t>(address), bench_->now());
  return resume();
}

base::Expected<int, TmclDebugger::Error> TmclDebugger::add_breakpoint(std::size_t address,
                                                                      const std::string& condition,
                                                                      bool temporary) {
  if (!condition.empty()) {
    if (const auto value = values_->evaluate(condition); !value) {
      return base::Unexpected{value.error()};
    }
  }
  stop_points_.push_back({.number = ++last_number_,
                          .address = address,
                          .condition = condition,
                          .temporary = temporary});
  return last_number_;
}

base::Expected<int, TmclDebugger::Error> TmclDebugger::add_watchpoint(
    const std::string& expression) {
  const auto value = values_->evaluate(expression);
  if (!value) {
    return base::Unexpected{value.error()};
  }
  stop_points_.push_back({.number = ++last_number_, .expression = expression, .value = *value});
  return last_number_;
}

StopPoint* TmclDebugger::find_stop_point(int number) {
  const auto found = std::ranges::find(stop_points_, number, &StopPoint::number);
  return found != stop_points_.end() ? &*found : nullptr;
}

bool TmclDebugger::remove_stop_point(int number) {
  return std::erase_if(stop_points_,
                       [number](const StopPoint& each) { return each.number == number; }) != 0;
}

bool TmclDebugger::has_breakpoint(std::size_t address) const {
  return std::ranges::any_of(stop_points_, [address](const StopPoint& each) {
    return each.enabled && each.address == address;
  });
}

bool TmclDebugger::watches() const {
  return std::ranges::any_of(
      stop_points_, [](const StopPoint& each) { return each.enabled && !each.expression.empty(); });
}

bool TmclDebugger::counts(StopPoint& point) {
  if (!point.condition.empty()) {
    // A condition that lost its value, by a parameter that can not be read, holds the program.
    const auto value = values_->evaluate(point.condition);
    if (value && *value == 0) {
      return false;
    }
  }
  ++point.hits;
  if (point.ignore > 0) {
    --point.ignore;
    return false;
  }
  return true;
}

std::optional<Stop> TmclDebugger::changed_watchpoint() {
  for (StopPoint& point : stop_points_) {
    if (!point.enabled || point.expression.empty()) {
      continue;
    }
    const auto value = values_->evaluate(point.expression);
    if (!value || *value == point.value) {
      continue;
    }
    const std::int64_t old_value = std::exchange(point.value, *value);
    if (counts(point)) {
      return Stop{StopCause::watchpoint, point.number, old_value, *value};
    }
  }
  return std::nullopt;
}

std::optional<Stop> TmclDebugger::hit_breakpoint() {
  std::optional<Stop> stop;
  for (StopPoint& point : stop_points_) {
    if (point.enabled && point.address == address() && counts(point) && !stop) {
      stop = Stop{.cause = StopCause::breakpoint, .number = point.number};
    }
  }
  if (stop && find_stop_point(stop->number)->temporary) {
    remove_stop_point(stop->number);
  }
  return stop;
}

}  // namespace stator::tmcl_tools
