#include "stator/control/motion_controller/encoder_interface.hpp"

#include <utility>

#include "stator/control/motion_controller/motion_controller_settings.hpp"

namespace stator::control::motion_controller {

namespace {

constexpr std::int64_t kBinaryBase = 65'536;
constexpr std::int64_t kDecimalBase = 10'000;

}  // namespace

void EncoderInterface::set_constant(std::uint32_t constant) {
  constant_ = constant;
  update_increment();
}

void EncoderInterface::set_mode(std::uint32_t mode) {
  mode_ = mode;
  cleared_once_ = false;
  const std::int64_t base = has(encoder_mode::kDecimal) ? kDecimalBase : kBinaryBase;
  remainder_ = remainder_ * base / base_;
  base_ = base;
  update_increment();
}

void EncoderInterface::update_increment() {
  increment_ = has(encoder_mode::kDecimal)
                   ? (constant_ >> 16U) * kDecimalBase + (constant_ & 0xFFFFU)
                   : constant_;
}

void EncoderInterface::set_position(std::int32_t position) {
  whole_ = static_cast<std::uint32_t>(position);
  remainder_ = 0;
}

bool EncoderInterface::read_status() {
  return std::exchange(status_, false);
}

/// Moves the position by a number of counts.
void EncoderInterface::move(std::int64_t counts) {
  const std::int64_t sum = remainder_ + counts * increment_;
  std::int64_t whole = sum / base_;
  remainder_ = sum % base_;
  if (remainder_ < 0) {
    remainder_ += base_;
    --whole;
  }
  whole_ += static_cast<std::uint32_t>(whole);
}

void EncoderInterface::sample(const base::AxisSensing& sensing) {
  if (!sampled_) {
    sampled_ = true;
    count_ = sensing.encoder_count;
    note_where_it_stands(sensing);
    return;
  }
  const std::int64_t counts = sensing.encoder_count - count_;
  if (counts != 0) {
    count_ = sensing.encoder_count;
    move(counts);
  }
  look_at_null_channel(sensing);
}

/// A and B as AP 43 asks for them at `count`. Counting up from the mark the pair (A, B) goes
/// through 11, 01, 00, 10: A leads B when the shaft turns forward.
bool EncoderInterface::levels_match(std::int64_t count) const {
  if (has(encoder_mode::kIgnoreAb)) {
    return true;
  }
  const std::int64_t phase = (count - mark_) & 3;
  const bool a = phase == 0 || phase == 3;
  const bool b = phase == 0 || phase == 1;
  return a == has(encoder_mode::kChannelA) && b == has(encoder_mode::kChannelB);
}

/// The first look at the null channel makes no event.
void EncoderInterface::note_where_it_stands(const base::AxisSensing& sensing) {
  passages_ = sensing.encoder_index_passages;
  mark_ = sensing.encoder_index_count;
  in_mark_ = passages_ != 0 && count_ == mark_;
  active_ = sensing.encoder_index == has(encoder_mode::kNullActiveHigh) && levels_match(count_);
}

void EncoderInterface::look_at_null_channel(const base::AxisSensing& sensing) {
  const bool entered = passages_ != sensing.encoder_index_passages;
  passages_ = sensing.encoder_index_passages;
  mark_ = sensing.encoder_index_count;
  const bool was_in_mark = std::exchange(in_mark_, passages_ != 0 && count_ == mark_);
  const bool left = entered ? was_in_mark || !in_mark_ : was_in_mark && !in_mark_;
  const bool active_level = has(encoder_mode::kNullActiveHigh);
  const bool positive = has(encoder_mode::kPositiveEdge);
  const bool negative = has(encoder_mode::kNegativeEdge);
  const bool mark_level = sensing.encoder_index == in_mark_;
  if (mark_level == active_level) {
    active_ = false;
    if (levels_match(mark_)) {
      if (entered ? positive || !negative : in_mark_ && !positive && !negative) {
        null_event(mark_);
      }
      if (left && negative) {
        null_event(count_ < mark_ ? mark_ - 1 : mark_ + 1);
      }
    }
    return;
  }
  const bool active = !in_mark_ && levels_match(count_);
  const bool was_active = std::exchange(active_, active);
  const bool passed = entered && has(encoder_mode::kIgnoreAb);
  const bool rises = (active && !was_active) || (passed && active);
  const bool falls = (!active && was_active) || passed;
  if ((positive && rises) || (negative && falls) || (!positive && !negative && active)) {
    null_event(count_);
  }
}

/// What happens at `count`, somewhere between the sample before and the present one.
void EncoderInterface::null_event(std::int64_t count) {
  const std::int64_t since = count_ - count;
  const std::uint32_t whole = whole_;
  const std::int64_t remainder = remainder_;
  move(-since);
  latched_ = position();
  status_ = true;
  if (!has(encoder_mode::kClearOnNull) || cleared_once_) {
    whole_ = whole;
    remainder_ = remainder;
    return;
  }
  whole_ = 0;
  remainder_ = 0;
  move(since);
  if (has(encoder_mode::kClearOnce) && !has(encoder_mode::kClearContinuously)) {
    mode_ &= ~encoder_mode::kClearOnce;
    cleared_once_ = true;
  }
}

}  // namespace stator::control::motion_controller
