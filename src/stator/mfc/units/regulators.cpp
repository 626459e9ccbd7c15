#include "stator/mfc/units/regulators.hpp"

#include <algorithm>
#include <array>

namespace stator::mfc {

namespace {

constexpr std::array<std::uint16_t, 4> kSaw{250, 125, 500, 1000};
constexpr std::array<std::uint16_t, 4> kOscillator{240, 130, 470, 890};
constexpr std::array<std::uint16_t, 4> kPercent{100, 150, 200, 50};
constexpr unsigned kAdjustable = 8;  ///< bits from the fixed regulator's to the adjustable one's

RegulatorSettings decode(unsigned bits) {
  return {.saw_kilohertz = kSaw[bits & 3U],
          .oscillator_kilohertz = kOscillator[bits & 3U],
          .amplification_code = static_cast<std::uint8_t>(bits >> 2 & 3U),
          .damping_code = static_cast<std::uint8_t>(bits >> 4 & 3U),
          .over_current_protection = (bits >> 6 & 1U) == 0,
          .enabled = (bits >> 7 & 1U) == 0};
}

std::int32_t ramped(std::int32_t target, base::SimDuration since) {
  const std::int64_t on =
      std::clamp<std::int64_t>(since.nanoseconds(), 0, Regulators::kSoftStart.nanoseconds());
  return static_cast<std::int32_t>(target * on / Regulators::kSoftStart.nanoseconds());
}

}  // namespace

std::uint16_t regulator_percent(std::uint8_t code) {
  return kPercent[code & 3U];
}

RegulatorSettings Regulators::fixed() const {
  return decode(configuration_ & 0x7FU);  // bit 7 is reserved: this one can not be switched off
}

RegulatorSettings Regulators::adjustable() const {
  return decode(static_cast<unsigned>(configuration_) >> kAdjustable);
}

void Regulators::configure(base::SimTime time, std::uint16_t configuration) {
  const bool was_enabled = adjustable().enabled;
  configuration_ = configuration;
  if (!was_enabled && adjustable().enabled) {
    adjustable_on_since_ = time;
  }
}

void Regulators::set_adjustable_target(std::int32_t millivolts, std::int32_t supply_millivolts) {
  target_ =
      std::clamp(millivolts, std::min(kLeastAdjustable, supply_millivolts), supply_millivolts);
}

void Regulators::set_adjustable_overheated(base::SimTime time, bool overheated) {
  if (overheated_ && !overheated) {
    adjustable_on_since_ = time;
  }
  overheated_ = overheated;
}

std::int32_t Regulators::fixed_voltage(base::SimTime time) const {
  return fixed_short_ ? 0 : ramped(kFixedOutput, time - base::SimTime());
}

std::int32_t Regulators::adjustable_voltage(base::SimTime time) const {
  if (!adjustable().enabled || adjustable_short_ || overheated_) {
    return 0;
  }
  return ramped(target_, time - adjustable_on_since_);
}

}  // namespace stator::mfc
