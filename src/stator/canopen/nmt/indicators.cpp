#include "stator/canopen/nmt/indicators.hpp"

namespace stator::canopen {

using base::LedPattern;

LedPattern run_led(NmtState state) {
  switch (state) {
    case NmtState::initialisation:
      return LedPattern::off;
    case NmtState::stopped:
      return LedPattern::single_flash;
    case NmtState::pre_operational:
      return LedPattern::blinking;
    case NmtState::operational:
      return LedPattern::on;
  }
  return LedPattern::off;
}

LedPattern error_led(const ErrorIndication& indication) {
  if (indication.bus_off) {
    return LedPattern::on;
  }
  if (indication.error_control_event) {
    return LedPattern::double_flash;
  }
  return indication.warning_limit_reached ? LedPattern::single_flash : LedPattern::off;
}

}  // namespace stator::canopen
