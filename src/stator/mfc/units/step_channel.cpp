#include "stator/mfc/units/step_channel.hpp"

#include <algorithm>

namespace stator::mfc {

namespace {

constexpr std::uint64_t kTurn = std::uint64_t{1} << 32;  ///< of the accumulator: one step
/// From a write to the first addition, besides SD_DELAY: one tick behind the delay, two of the
/// pulse's logic (L9667-L9690).
constexpr std::int64_t kLatency = 3;

constexpr std::uint64_t magnitude(std::int32_t rate) {
  return rate < 0 ? static_cast<std::uint64_t>(-std::int64_t{rate})
                  : static_cast<std::uint64_t>(rate);
}

}  // namespace

bool StepChannel::running() const {
  return configuration_.enable && rate_ != 0 && (configuration_.continuous || remaining_ > 0);
}

void StepChannel::start() {
  accumulator_ = 0;
  origin_ = now_ + delay_ + kLatency;
}

/// What the next event depends on has changed.
void StepChannel::plan() {
  event_ = running() ? tick_of_step(steps_to_event()) : kNever;
}

void StepChannel::write_rate(std::int32_t rate) {
  if (rate == rate_) {
    return;
  }
  const bool was_running = running();
  const bool turns = (rate < 0) != (rate_ < 0);
  rate_ = rate;
  if (running() && (!was_running || turns || restart_on_new_rate_)) {
    start();
  }
  plan();
}

void StepChannel::write_target(std::uint32_t steps) {
  const bool was_running = running();
  remaining_ = steps;
  if (running() && !was_running) {
    start();
  }
  plan();
}

void StepChannel::write_configuration(Configuration configuration) {
  const bool was_running = running();
  configuration_ = configuration;
  if (running() && !was_running) {
    start();
  }
  plan();
}

std::uint64_t StepChannel::steps_until(std::int64_t tick) const {
  if (tick <= origin_) {
    return 0;
  }
  // (accumulator + |c| ticks) / 2^32, in two halves because the product can have 90 bits.
  const auto ticks = static_cast<std::uint64_t>(tick - origin_);
  const std::uint64_t rate = magnitude(rate_);
  return rate * (ticks >> 32) + ((accumulator_ + rate * (ticks & (kTurn - 1))) >> 32);
}

std::int64_t StepChannel::tick_of_step(std::uint64_t step) const {
  // ceil((step 2^32 - accumulator) / |c|); `step` is 1 to 2^32, so the sum just fits.
  const std::uint64_t below = ((step - 1) << 32) + (kTurn - 1 - accumulator_);
  const std::uint64_t ticks = below / magnitude(rate_);
  const auto most = static_cast<std::uint64_t>(kNever - 1 - origin_);
  return ticks < most ? origin_ + static_cast<std::int64_t>(ticks) + 1 : kNever;
}

std::uint64_t StepChannel::steps_to_event() const {
  const auto compare = static_cast<std::uint32_t>(compare_);
  const std::uint32_t distance = rate_ < 0 ? count_ - compare : compare - count_;
  const std::uint64_t to_compare = distance == 0 ? kTurn : distance;
  return configuration_.continuous ? to_compare : std::min<std::uint64_t>(to_compare, remaining_);
}

void StepChannel::make_steps(std::uint64_t steps) {
  const auto counts = static_cast<std::uint32_t>(steps);
  if (rate_ < 0) {
    count_ -= counts;
    total_ -= static_cast<std::int64_t>(steps);
  } else {
    count_ += counts;
    total_ += static_cast<std::int64_t>(steps);
  }
  if (!configuration_.continuous) {
    remaining_ -= counts;
  }
}

/// Brings the accumulator to `tick`, with the steps up to then already made.
void StepChannel::pass_to(std::int64_t tick) {
  now_ = tick;
  if (now_ > origin_) {
    accumulator_ += static_cast<std::uint32_t>(magnitude(rate_)) *
                    static_cast<std::uint32_t>(static_cast<std::uint64_t>(now_ - origin_));
    origin_ = now_;
  }
}

/// The pulse of a step made at or before now_: the accumulator has grown by |c| in each tick since,
/// from less than |c|. A pulse that is over needs no moment at which it ended.
void StepChannel::pulse_from_last_step() {
  const std::uint64_t rate = magnitude(rate_);
  const std::uint64_t ticks = std::uint64_t{length_} + 1;
  pulse_end_ = accumulator_ < ticks * rate ? now_ - static_cast<std::int64_t>(accumulator_ / rate) +
                                                 static_cast<std::int64_t>(ticks)
                                           : now_;
}

StepChannel::Event StepChannel::advance(std::int64_t tick) {
  const bool event = event_ <= tick;
  if (!running() || (tick == now_ && !event)) {
    now_ = tick;
    return {};
  }
  const std::uint64_t steps = event ? steps_to_event() : steps_until(tick);
  if (steps > 0) {
    make_steps(steps);
  }
  pass_to(event ? event_ : tick);
  if (steps > 0) {
    pulse_from_last_step();
  }
  if (!event) {
    return {};
  }
  const Event happened{
      .tick = now_,
      .target_reached = !configuration_.continuous && remaining_ == 0,
      .compare = count_ == static_cast<std::uint32_t>(compare_),
  };
  if (happened.compare && configuration_.use_next_rate) {
    write_rate(next_rate_);
  }
  plan();
  return happened;
}

std::int64_t StepChannel::next_step() const {
  return running() ? tick_of_step(1) : kNever;
}

std::int64_t StepChannel::next_edge() const {
  return pulse() ? std::min(pulse_end_, next_step()) : next_step();
}

}  // namespace stator::mfc
