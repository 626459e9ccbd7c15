#include "stator/control/foc/hall_decoder.hpp"

#include <algorithm>
#include <cstddef>

namespace stator::control::foc {
namespace {

/// Sector 0..5 of the levels UX, V, WY (bits 0, 1, 2); -1 for the two that cannot be.
constexpr std::array<int, 8> kSectors{-1, 0, 2, 1, 4, 5, 3, -1};

}  // namespace

void HallDecoder::configure(const HallSettings& settings) {
  settings_ = settings;
  constexpr std::int64_t kFilterStep = 500;            // 5 us in ticks
  constexpr std::int64_t kTicksAt60Rpm = 100'000'000;  // of a revolution
  filter_ticks_ = settings.filter * kFilterStep;
  slowest_sector_ = kTicksAt60Rpm / (6 * std::int64_t{std::max(settings.pole_pairs, 1)});
  if (sector_ >= 0) {
    phi_e_ = placed(settings_.position[static_cast<std::size_t>(sector_)]);
    active_ = active_ && settings_.interpolated;
    interpolated_ = active_ ? interpolated_ : phi_e_;
  }
  update_mechanical();
}

void HallDecoder::update_mechanical() {
  const std::int64_t pole_pairs = std::max(settings_.pole_pairs, 1);
  phi_m_ = wrap_s16(floor_division(turned_, pole_pairs) + settings_.phi_m_offset);
}

std::int32_t HallDecoder::longest_calm(const PwmPeriod& pwm) {
  if (pwm.chopper < Chopper::low_side || pwm.half_bridges == 0) {
    return INT32_MAX;
  }
  // Edges lie symmetrically about the middle of the period: one calm between the innermost, one
  // around the begin, and between any two edges half the difference of the on-times.
  std::int32_t shortest = pwm.period;
  std::int32_t longest_on = 0;
  std::int32_t calm = 0;
  for (unsigned k = 0; k < pwm.half_bridges; ++k) {
    const std::int32_t on = pwm.on_time[k];
    std::int32_t next = INT32_MAX;
    for (unsigned other = 0; other < pwm.half_bridges; ++other) {
      next = pwm.on_time[other] > on ? std::min(next, pwm.on_time[other]) : next;
    }
    calm = next == INT32_MAX ? calm : std::max(calm, (next - on) / 2);
    shortest = std::min(shortest, on);
    longest_on = std::max(longest_on, on);
  }
  return std::max({calm, shortest, pwm.period - longest_on});
}

void HallDecoder::accept(std::uint8_t levels) {
  filtered_ = levels;
  const int sector = kSectors[(settings_.inverted ? ~levels : levels) & 7];
  if (sector >= 0 && sector != sector_) {
    enter(sector);
  }
}

void HallDecoder::enter(int sector) {
  const std::int32_t position = placed(settings_.position[static_cast<std::size_t>(sector)]);
  const bool first = sector_ < 0;
  sector_ = sector;
  if (first) {
    phi_e_ = border_ = interpolated_ = position;
    turned_ = position;
    update_mechanical();
    return;
  }
  const std::int32_t turned = wrap_s16(std::int64_t{position} - phi_e_);
  const std::int32_t border = wrap_s16(phi_e_ + turned / 2);
  const int direction = turned < 0 ? -1 : 1;
  // Only a sector crossed from border to border tells a speed.
  active_ = settings_.interpolated && direction == direction_ && since_edge_ < slowest_sector_;
  if (active_) {
    increment_ = std::int64_t{wrap_s16(std::int64_t{border} - border_)} * (std::int64_t{1} << 32) /
                 since_edge_;
  }
  direction_ = direction;
  border_ = border;
  since_edge_ = 0;
  ++edges_;
  turned_ += turned;
  phi_e_ = position;
  interpolated_ = position;
  update_mechanical();
}

void HallDecoder::interpolate() {
  if (since_edge_ >= slowest_sector_) {
    active_ = false;
    interpolated_ = phi_e_;
    return;
  }
  const std::int64_t ahead = (increment_ * since_edge_) >> 32;
  const std::int64_t most = settings_.largest_interpolation;
  interpolated_ = wrap_s16(border_ + std::clamp(ahead, -most, most));
}

}  // namespace stator::control::foc
