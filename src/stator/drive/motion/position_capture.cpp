#include "stator/drive/motion/position_capture.hpp"

namespace stator::drive {

void PositionCapture::arm_release(ReferenceSwitch which, bool then_index) {
  captured_.reset();
  switch_ = which;
  then_index_ = then_index;
  waits_for_ = Event::press;
}

void PositionCapture::arm_index() {
  captured_.reset();
  waits_for_ = Event::first_look_at_index;
}

void PositionCapture::observe(const ReferenceSignals& signals, const ReferenceSettings& settings,
                              bool index_used, std::int64_t motor_microsteps) {
  const auto pressed = [&] { return settings.switches.pressed(signals.switches).of(switch_); };
  switch (waits_for_) {
    case Event::nothing:
      break;
    case Event::press:
      if (pressed()) {
        waits_for_ = Event::release;
      }
      break;
    case Event::release:
      if (pressed()) {
        break;
      }
      if (then_index_) {
        look_at_index(signals, settings.index_active_low);
        waits_for_ = Event::index;
        break;
      }
      captured_ = {motor_microsteps, signals.encoder_count};
      waits_for_ = Event::nothing;
      break;
    case Event::first_look_at_index:
      look_at_index(signals, settings.index_active_low);
      waits_for_ = Event::index;
      break;
    case Event::index:
      if (const auto count = index_pulse(signals, settings.index_active_low); count && index_used) {
        captured_ = {motor_microsteps, *count};
        waits_for_ = Event::nothing;
      }
      break;
  }
}

void PositionCapture::look_at_index(const ReferenceSignals& signals, bool active_low) {
  index_passages_ = signals.encoder_index_passages;
  index_active_ = signals.encoder_index != active_low;
}

/// The count at which the N channel has become active since the last look.
std::optional<std::int64_t> PositionCapture::index_pulse(const ReferenceSignals& signals,
                                                         bool active_low) {
  const bool met = signals.encoder_index_passages != index_passages_;
  const bool was_active = index_active_;
  look_at_index(signals, active_low);
  const std::int64_t mark = signals.encoder_index_count;
  const bool on_mark = signals.encoder_count == mark;
  if (index_active_ == on_mark) {
    return met ? std::optional(mark) : std::nullopt;
  }
  // The polarity is set wrongly: N is active everywhere but on the mark, so it becomes active one
  // count behind it.
  if (on_mark || !(met || !was_active)) {
    return std::nullopt;
  }
  return signals.encoder_count > mark ? mark + 1 : mark - 1;
}

}  // namespace stator::drive
