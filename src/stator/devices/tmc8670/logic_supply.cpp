#include "stator/devices/tmc8670/logic_supply.hpp"

namespace stator::devices::tmc8670 {

namespace {

/// Arguments: {0} the supply, {1} mV, {2} and {3} the limits in mV.
constexpr base::EventRule kOutOfRange{
    "tmc8670-logic-supply", base::Severity::fault,
    "{0} has {1} mV, operation needs {2} to {3} mV: the chip is held in reset until it has"};
constexpr base::EventRule kDamaged{
    "tmc8670-logic-supply-maximum", base::Severity::fault,
    "{0} has {1} mV, the absolute maximum ratings are {2} to {3} mV: the chip is damaged and stays "
    "off until the rack starts anew"};
constexpr base::EventRule kBack{"tmc8670-logic-supply-back", base::Severity::information,
                                "the supplies of the logic are in range again: the chip starts"};

std::int64_t millivolts(double volts) {
  return static_cast<std::int64_t>(volts * 1000.0 + (volts < 0.0 ? -0.5 : 0.5));
}

}  // namespace

void LogicSupply::set_voltage(std::size_t rail, double volts, base::SimTime now) {
  volts_[rail] = volts;
  judge(now);
}

void LogicSupply::switch_on(bool on, base::SimTime now) {
  on_ = on;
  judge(now);
}

void LogicSupply::judge(base::SimTime now) {
  if (state_ == State::damaged) {
    return;
  }
  if (!on_) {
    state_ = State::off;
    return;
  }
  const State former = state_;
  state_ = State::good;
  for (std::size_t i = 0; i < kLogicRails.size(); ++i) {
    const LogicRail& rail = kLogicRails[i];
    if (volts_[i] < rail.absolute_minimum || volts_[i] > rail.absolute_maximum) {
      state_ = State::damaged;
      reporter_.report(now, kDamaged,
                       {rail.name, millivolts(volts_[i]), millivolts(rail.absolute_minimum),
                        millivolts(rail.absolute_maximum)});
      return;
    }
    if (volts_[i] < rail.operating_minimum || volts_[i] > rail.operating_maximum) {
      state_ = State::low_or_high;
      if (former != State::low_or_high) {
        reporter_.report(now, kOutOfRange,
                         {rail.name, millivolts(volts_[i]), millivolts(rail.operating_minimum),
                          millivolts(rail.operating_maximum)});
      }
    }
  }
  if (former == State::low_or_high && state_ == State::good) {
    reporter_.report(now, kBack);
  }
}

}  // namespace stator::devices::tmc8670
