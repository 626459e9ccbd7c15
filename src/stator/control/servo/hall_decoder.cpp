#include "stator/control/servo/hall_decoder.hpp"

#include <array>

namespace stator::control {

namespace {

constexpr std::uint8_t kInvalid = 0xFF;

/// Sixth of the electrical turn that a code of the sensors names.
constexpr std::array<std::uint8_t, 8> kSectorOfCode = {kInvalid, 0, 2, 1, 4, 5, 3, kInvalid};

/// The nearest to n / 6 turn.
constexpr ElectricalAngle middle_of(unsigned sector) {
  return {static_cast<std::uint32_t>((std::uint64_t{sector} * 4'294'967'296U + 3U) / 6U)};
}

}  // namespace

void HallDecoder::configure(bool inverted, bool interpolated, std::uint32_t slowest) {
  const std::uint8_t inversion = inverted ? 0b111 : 0;
  if (inversion != inversion_) {
    inversion_ = inversion;
    levels_ = kNothing;  // another code, another sixth: not a movement
    placed_ = false;
    error_ = false;
  }
  interpolated_ = interpolated;
  interpolating_ = interpolating_ && interpolated;
  slowest_ = slowest;
}

bool HallDecoder::change(std::uint8_t levels, std::uint32_t period) {
  levels_ = levels;
  const std::uint8_t sector = kSectorOfCode[(levels ^ inversion_) & 0b111U];
  valid_ = sector != kInvalid;
  if (!valid_) {
    error_ = true;
    interpolating_ = false;
    return false;
  }
  if (!placed_) {
    placed_ = true;
    sector_ = sector;
    middle_ = middle_of(sector);
    edge_ = middle_;
    edge_period_ = period;
    return false;
  }
  if (sector == sector_) {
    return false;
  }
  enter(sector, period);
  return true;
}

void HallDecoder::enter(unsigned sector, std::uint32_t period) {
  const unsigned ahead = (sector + 6U - sector_) % 6U;
  const bool forward = ahead <= 3U;
  if (ahead == 1U || ahead == 5U) {
    const std::uint32_t duration = period - edge_period_;
    interpolating_ = interpolated_ && forward == forward_ && duration > 0 && duration <= slowest_;
    rate_ = interpolating_ ? kSixthTurn.value / duration : 0;
  } else {
    error_ = true;
    interpolating_ = false;
  }
  if (ahead != 3U) {
    position_ += forward ? std::int64_t{ahead} : std::int64_t{ahead} - kStepsPerTurn;
    forward_ = forward;
  }
  sector_ = static_cast<std::uint8_t>(sector);
  edge_period_ = period;
  middle_ = middle_of(sector);
  edge_ = forward_ ? middle_ - kTwelfthTurn : middle_ + kTwelfthTurn;
}

ElectricalAngle HallDecoder::interpolated_angle(std::uint32_t period) const {
  const std::uint32_t elapsed = period - edge_period_;
  if (elapsed > slowest_) {
    return middle_;
  }
  // The edge came somewhere in the period before it was seen: half a period on average.
  const std::uint64_t way = std::uint64_t{rate_} * elapsed + rate_ / 2;
  const ElectricalAngle moved{way < kSixthTurn.value ? static_cast<std::uint32_t>(way)
                                                     : kSixthTurn.value};
  return forward_ ? edge_ + moved : edge_ - moved;
}

}  // namespace stator::control
