#include "stator/mfc/units/pwm_geometry.hpp"

#include <algorithm>
#include <span>

namespace stator::mfc {

namespace {

constexpr std::int64_t modulo(std::int64_t value, std::int64_t counts) {
  const std::int64_t rest = value % counts;
  return rest < 0 ? rest + counts : rest;
}

/// Where PWM is on within a period, by the code of PWM_CFG bits 33:32. The codes are a guess
/// 3 is taken for 1.
enum class Alignment : std::uint8_t { left, centered, right };
constexpr std::array<Alignment, 4> kAlignments{Alignment::left, Alignment::centered,
                                               Alignment::right, Alignment::centered};

// Fields of PWM_CFG (L7263-L7341).
constexpr std::int64_t maxcnt(std::uint64_t configuration) {
  return static_cast<std::int64_t>(configuration & 0x0FFF);
}
constexpr unsigned chop_mode(std::uint64_t configuration, std::size_t channel) {
  return static_cast<unsigned>(configuration >> (16 + 4 * channel)) & 7U;
}
constexpr Alignment alignment(std::uint64_t configuration) {
  return kAlignments[configuration >> 32 & 3U];
}
constexpr unsigned kInvertLowSide = 40;
constexpr unsigned kInvertHighSide = 41;
/// Of the pulses A, center, B, AB, zero.
constexpr std::array<unsigned, 5> kInvertPulse{45, 44, 43, 42, 46};

/// Marks, as next_mark() numbers them.
enum Mark : std::uint8_t { zero = 0, center = 1, a = 2, b = 3 };

}  // namespace

std::int64_t PwmGeometry::phase(std::int64_t tick) const {
  return (tick - zero_) % counts();
}

std::int64_t PwmGeometry::next_at(std::int64_t position, std::int64_t tick) const {
  if (stands()) {
    return kNever;
  }
  std::int64_t distance = position - phase(tick);
  if (distance < 0) {
    distance += counts();
  }
  if (distance < 0 || distance >= counts()) {
    distance = modulo(distance, counts());
  }
  return tick + (distance == 0 ? counts() : distance);
}

PwmGeometry::Window PwmGeometry::window(std::size_t channel) const {
  const std::int64_t duty = std::min<std::int64_t>(settings_.duty[channel], counts());
  std::int64_t begin = 0;
  switch (alignment(settings_.configuration)) {
    case Alignment::left:
      break;
    case Alignment::centered:
      begin = (counts() - duty) / 2;
      break;
    case Alignment::right:
      begin = counts() - duty;
      break;
  }
  return {.begin = (begin + settings_.shift[channel]) % counts(), .length = duty};
}

PwmGeometry::Request PwmGeometry::request(std::size_t channel, Side side) const {
  if (settings_.emergency) {
    return Request::off;
  }
  using enum Request;
  // Table 205: high side, low side.
  static constexpr std::array<std::array<Request, 2>, 8> kModes{{{off, off},
                                                                 {off, on},
                                                                 {on, off},
                                                                 {off, off},
                                                                 {off, off},
                                                                 {off, pwm},
                                                                 {pwm, off},
                                                                 {pwm, not_pwm}}};
  const Request request = kModes[chop_mode(settings_.configuration, channel)][side];
  const std::int64_t length = window(channel).length;
  if (request == pwm || request == not_pwm) {
    if (length == 0) {
      return request == pwm ? off : on;
    }
    if (length == counts()) {
      return request == pwm ? on : off;
    }
  }
  return request;
}

std::int64_t PwmGeometry::pause(Side side) const {
  // BBM_L before the low side is turned on, BBM_H before the high side.
  return static_cast<std::int64_t>(settings_.configuration >> (side == low_side ? 48 : 56) & 0xFF);
}

bool PwmGeometry::wanted(std::size_t channel, Side side, std::int64_t tick) const {
  const Request what = request(channel, side);
  if (what == Request::off || what == Request::on) {
    return what == Request::on;
  }
  const Window on = window(channel);
  const bool inside = modulo(phase(tick) - on.begin, counts()) < on.length;
  return inside == (what == Request::pwm);
}

std::int64_t PwmGeometry::off_since(std::size_t channel, Side side, std::int64_t tick) const {
  const Request what = request(channel, side);
  if (what == Request::pwm || what == Request::not_pwm) {
    const Window on = window(channel);
    const std::int64_t end = what == Request::pwm ? on.begin + on.length : on.begin;
    const std::int64_t last = tick - modulo(phase(tick) - end, counts());
    if (last > changed_at_) {
      return last;
    }
  }
  return off_before_[channel][side];
}

bool PwmGeometry::gate(std::size_t channel, Side side, std::int64_t tick) const {
  const Side other = side == high_side ? low_side : high_side;
  return wanted(channel, side, tick) && !wanted(channel, other, tick) &&
         tick - off_since(channel, other, tick) >= pause(side);
}

std::int64_t PwmGeometry::mark_position(std::size_t mark) const {
  switch (mark) {
    case Mark::zero:
      return 0;
    case Mark::center:
      return maxcnt(settings_.configuration) / 2;
    case Mark::a:
      return settings_.marks & 0x0FFF;
    default:
      return settings_.marks >> 16 & 0x0FFF;
  }
}

bool PwmGeometry::pulse(std::size_t mark, std::int64_t tick) const {
  const std::int64_t position = mark_position(mark);
  return !stands() && position < counts() &&
         modulo(phase(tick) - position, counts()) < settings_.pulse_length;
}

bool PwmGeometry::output(std::size_t output, std::int64_t tick) const {
  const auto inverted = [&](unsigned bit) { return (settings_.configuration >> bit & 1U) != 0; };
  if (output < 2 * kChannels) {
    const Side side = output % 2 == 0 ? high_side : low_side;
    return gate(output / 2, side, tick) !=
           inverted(side == high_side ? kInvertHighSide : kInvertLowSide);
  }
  const std::size_t which = output - 2 * kChannels;
  const bool invert = inverted(kInvertPulse[which]);
  switch (which) {
    case 0:
      return pulse(Mark::a, tick) != invert;
    case 1:
      return pulse(Mark::center, tick) != invert;
    case 2:
      return pulse(Mark::b, tick) != invert;
    case 3:
      return (pulse(Mark::a, tick) || pulse(Mark::b, tick)) != invert;
    default:
      return pulse(Mark::zero, tick) != invert;
  }
}

std::int64_t PwmGeometry::next_mark(std::size_t mark, std::int64_t tick) const {
  const std::int64_t position = mark_position(mark);
  return position < counts() ? next_at(position, tick) : kNever;
}

std::int64_t PwmGeometry::next_change(std::size_t output, std::int64_t tick) const {
  // Places in the period at which the output can change, and once a pause left from old settings.
  std::array<std::int64_t, 4> positions{};
  std::size_t count = 0;
  std::int64_t once = 0;
  if (output < 2 * kChannels) {
    const Side side = output % 2 == 0 ? high_side : low_side;
    const Window on = window(output / 2);
    const std::int64_t delay = pause(side);
    positions = {on.begin, on.begin + on.length, on.begin + delay, on.begin + on.length + delay};
    count = 4;
    once = off_before_[output / 2][side == high_side ? low_side : high_side] + delay;
  } else {
    static constexpr std::array<std::array<std::size_t, 2>, 5> kMarksOf{
        {{Mark::a, Mark::a},
         {Mark::center, Mark::center},
         {Mark::b, Mark::b},
         {Mark::a, Mark::b},
         {Mark::zero, Mark::zero}}};
    for (const std::size_t mark : kMarksOf[output - 2 * kChannels]) {
      positions[count++] = mark_position(mark);
      positions[count++] = mark_position(mark) + settings_.pulse_length;
    }
  }
  std::array<std::int64_t, 9> candidates{};
  std::size_t found = 0;
  const auto add = [&](std::int64_t candidate) {
    if (candidate > tick && candidate != kNever) {
      candidates[found++] = candidate;
    }
  };
  for (const std::int64_t position : std::span(positions).first(count)) {
    add(next_at(position, tick));
    if (once > tick) {
      add(next_at(position, once));
    }
  }
  add(once);
  std::sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(found));
  const bool level = this->output(output, tick);
  for (const std::int64_t candidate : std::span(candidates).first(found)) {
    if (this->output(output, candidate) != level) {
      return candidate;
    }
  }
  return kNever;
}

void PwmGeometry::reconfigure(const PwmSettings& settings, std::int64_t tick) {
  const std::int64_t position = phase(tick);
  for (std::size_t i = 0; i < kChannels; ++i) {
    for (const Side side : {high_side, low_side}) {
      off_before_[i][side] = wanted(i, side, tick) ? tick : off_since(i, side, tick);
    }
  }
  settings_ = settings;
  changed_at_ = tick;
  zero_ = tick - (position < counts() ? position : 0);
}

OnShare PwmGeometry::on_share(std::size_t channel) const {
  const auto share = [&](Side side) {
    const std::int64_t length = window(channel).length;
    const bool both = chop_mode(settings_.configuration, channel) == 7;
    const std::int64_t waits = both ? pause(side) : 0;
    switch (request(channel, side)) {
      case Request::off:
        return 0.0;
      case Request::on:
        return 1.0;
      case Request::pwm:
        return static_cast<double>(std::max<std::int64_t>(length - waits, 0)) /
               static_cast<double>(counts());
      case Request::not_pwm:
        return static_cast<double>(std::max<std::int64_t>(counts() - length - waits, 0)) /
               static_cast<double>(counts());
    }
    return 0.0;
  };
  return {.high_side = share(high_side), .low_side = share(low_side)};
}

}  // namespace stator::mfc
